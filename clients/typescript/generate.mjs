// Makes src/rest.ts, the types of every operation and document, from the description of the service.
import { readFile, writeFile } from "node:fs/promises";
import openapi, { astToString } from "openapi-typescript";
import ts from "typescript";

const here = new URL(".", import.meta.url);
const description = JSON.parse(await readFile(new URL("../../openapi/openapi.json", here), "utf8"));
// Whoever asks for a range knows that bytes come; for everybody else the answer has one type.
for (const operations of Object.values(description.paths)) {
  for (const operation of Object.values(operations)) delete operation.responses?.["206"];
}
// A fixed array within a fixed array comes out as an array of them; one that has a name comes out right.
const { schemas } = description.components;
schemas.Interval = schemas.Intervals.items;
schemas.Intervals.items = { $ref: "#/components/schemas/Interval" };
const blob = ts.factory.createTypeReferenceNode("Blob");
const types = await openapi(description, {
  // Three numbers are three numbers, and a file is no text.
  arrayLength: true,
  // What has a default may be left out.
  defaultNonNullable: false,
  transform: (schema) => (schema.format === "binary" ? blob : undefined),
});
await writeFile(new URL("src/rest.ts", here), astToString(types));
