// A misspelt member of a document reaches the service, which refuses it by name: no silent default. The compiler finds
// it in a literal; this is a document from elsewhere.
import { Refused, answered, connect } from "./index.js";

const service = connect(process.env.FACIES_ADDRESS!, process.env.FACIES_API_KEY);

const segment = { name: "mandible", translation_mm: [4, 0, 1], rotation: [0, 5, 0] };
const document = { kind: "predict", case: "any", plan: { segments: [segment] } };
try {
  await answered(service.POST("/v1/jobs", { body: document as never }));
} catch (refused) {
  if (!(refused instanceof Refused)) throw refused;
  console.log(refused.message);
  process.exit(0);
}
throw new Error("a misspelt member was let through");
