// What `Facies` does while a service is away: a server of its own breaks off and comes back, and no pause takes any time.
import { strict as assert } from "node:assert";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { inspect } from "node:util";
import { Facies, FaciesError, Refused, Unreachable, type Documents } from "./facies.js";
import { answered, connect, ended, Refused as RefusedOfTyped } from "./index.js";
import { clock } from "./patience.js";

const job = "01890000-0000-7000-8000-000000000000";
const path = `/v1/jobs/${job}`;
const BREAKS = ": breaks\n\n";
const NO_GZIP = "no gzip";
/** In what the server says: the header that it was sent. */
const ECHO = "ECHO";
const [KEY, PASSWORD] = ["fcs_a/secret&key", "a%2Fpassword"];

// A clock that goes on by pauses alone.
let [now, pauses]: [number, number[]] = [0, []];
clock.now = () => now;
clock.sleep = async (seconds) => {
  pauses.push(seconds);
  now += seconds;
};

/** Lines of a stream or another text, a status, both, what is no answer, or `undefined` for a closed connection;
 * `silent` after a part of an answer, or before any. */
type Said = string | number | [number, string] | { raw: string } | { silent: string } | undefined;
let said: Said[] = [];
const asked: (string | undefined)[] = [];
const server = createServer((request, answer) => {
  request.resume();
  asked.push(request.headers["last-event-id"] as string | undefined);
  const next = said.length > 1 ? said.shift() : said[0];
  if (next === undefined) return void request.socket.destroy();
  const echoed = (text: string) => text.replaceAll(ECHO, request.headers.authorization ?? "");
  if (typeof next === "object" && "raw" in next) return void request.socket.end(echoed(next.raw));
  if (typeof next === "object" && "silent" in next) {
    if (next.silent !== "") answer.writeHead(200, { "Content-Length": 9 + next.silent.length }).write(next.silent);
    return;
  }
  const [status, text] = Array.isArray(next) ? next : typeof next === "number" ? [next, ""] : [200, next];
  const lines = echoed(text);
  // A stream that has not all that it promises breaks.
  const promised = lines.length + (lines.endsWith(BREAKS) ? 9 : 0);
  if (lines === NO_GZIP) answer.setHeader("Content-Encoding", "gzip");
  answer.writeHead(status, status === 204 ? {} : { "Content-Length": promised });
  if (promised === lines.length) answer.end(lines);
  else answer.write(lines, () => request.socket.end());
});
await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
const address = `http://127.0.0.1:${(server.address() as AddressInfo).port}`;
const service = new Facies(address, undefined, 60);

/** The server says this, the last of it again and again. */
function say(...all: Said[]) {
  [said, now, pauses, asked.length] = [all, 0, [], 0];
}

async function followed() {
  const events: Documents["JobEvent"][] = [];
  for await (const event of service.events(job)) events.push(event);
  return events;
}

const line = (number: number, status: string) => `data: {"number": ${number}, "status": "${status}"}\n\n`;
const isAway = (of: string | undefined) => (thrown: Error) =>
  thrown instanceof Unreachable && thrown.code === "unreachable" && thrown.job === of && thrown.cause instanceof TypeError;

// A stream is taken up behind the last event, at whatever point it broke; one that ends with its job is not waited for.
const begun = line(1, "running");
say(begun + BREAKS, undefined, 503, "retry: 2000\n\n", line(2, "running") + line(3, "successful"), 204);
assert.deepEqual((await followed()).map(({ number }) => number), [1, 2, 3]);
assert.deepEqual([asked, pauses], [["0", "1", "1", "1", "1", "3"], [1, 2, 4, 8]]);

// So is one that ends within an event, as if that had been all of it, or cannot be read.
const half = line(2, "running").slice(0, -9);
say(begun + half, `${half}\n${line(3, "successful")}`, NO_GZIP, line(2, "running") + line(3, "successful"), 204);
assert.deepEqual((await followed()).map(({ number }) => number), [1, 2, 3]);
assert.deepEqual([asked, pauses], [["0", "1", "1", "1", "3"], [1, 2, 4]]);
for (const one of [half, `${half}\n`, NO_GZIP]) {
  say(one);
  await assert.rejects(followed(), (thrown) => thrown instanceof Unreachable && thrown.job === job);
  assert.deepEqual(pauses, [1, 2, 4, 8, 16, 20]);
}

// Where something keeps what was said, it is told once.
say(line(1, "running") + line(2, "successful"));
const once: number[] = [];
await assert.rejects(async () => {
  for await (const { number } of service.events(job)) once.push(number);
}, (thrown) => thrown instanceof Unreachable && thrown.job === job);
assert.deepEqual([once, pauses], [[1, 2], [1, 2, 4, 8, 16, 20]]);

// Silence is no answer, before one or within it.
clock.most_silence_s = 0.05;
say({ silent: "" }, { silent: begun }, { silent: ": alive\n\n" }, line(1, "running") + line(2, "successful"), 204);
assert.deepEqual((await followed()).map(({ number }) => number), [1, 2]);
assert.deepEqual([asked, pauses], [["0", "0", "1", "1", "2"], [1, 1, 1]]);
say({ silent: "" }, { silent: "half of" }, "all of it");
assert.equal(new TextDecoder().decode(await service.file(job, "report.html")), "all of it");
say({ silent: "" });
await assert.rejects(service.run({} as Documents["JobDocument"]), isAway(undefined));
await assert.rejects(ended(connect(address), { id: job, status: "running" } as Documents["StatusInfo"], 5), isAway(job));
clock.most_silence_s = 60;

// Pauses grow to a bound, and the last exception names the job; the silence of a stream is counted from its last sign of life.
say(begun, ": alive\n\n", undefined);
await assert.rejects(followed(), isAway(job));
assert.deepEqual(pauses, [1, 1, 2, 4, 8, 16, 20]);

// One that is refused, or for which there is no place for all that time, says so.
for (const [status, requests] of [[404, 1], [503, 7]] as const) {
  say(status);
  await assert.rejects(followed(), (thrown) => thrown instanceof Refused && thrown.problem.status === status);
  assert.equal(asked.length, requests);
}

// A request that reads is sent again, one that may change something is not, unless the service knows it by its key.
say(undefined, 502, 200);
assert((await service.ask("GET", path)).ok);
assert.deepEqual(pauses, [1, 2]);
say(undefined, 200);
assert((await service.ask("POST", "/v1/jobs", "{}", { "idempotency-key": "a" })).ok);
say(undefined);
await assert.rejects(service.ask("POST", "/v1/jobs", "{}"), isAway(undefined));
await assert.rejects(service.upload(new Blob(["mesh"]), "mm", "LPS", () => undefined), isAway(undefined));
assert.equal(asked.length, 2);
await assert.rejects(service.file(job, "skin.glb"), isAway(job));
assert.equal(asked.length, 9);
// A file that breaks off is asked for again, too.
say(BREAKS, "all of it");
assert.equal(new TextDecoder().decode(await service.file(job, "report.html")), "all of it");

// So is what breaks off while `ask` reads it.
say(BREAKS, "all of it");
assert.equal(await (await service.ask("GET", path)).text(), "all of it");

// An answer that cannot be read is none, and one that is no document is not of the service.
say(NO_GZIP, "all of it");
assert.equal(new TextDecoder().decode(await service.file(job, "report.html")), "all of it");
say([403, NO_GZIP]);
await assert.rejects(service.file(job, "report.html"), isAway(job));
say(NO_GZIP);
await assert.rejects(service.run({} as Documents["JobDocument"]), isAway(undefined));
const asks: (() => Promise<unknown>)[] = [
  () => service.run({} as Documents["JobDocument"]), () => service.createCase({} as Documents["CaseDocument"]),
  () => service.upload(new Blob(["mesh"])), () => service.upload(new Blob(["mesh"]), "mm", "LPS", () => undefined),
];
for (const text of ["<html>welcome</html>", '{"id": "0189', "", "[]"]) {
  for (const asksFor of asks) {
    say(text);
    await assert.rejects(asksFor(), (thrown) => thrown instanceof Refused && thrown.code === "not-of-the-service"
      && thrown.problem.status === 200 && thrown.message.endsWith(`answered ${text}`));
    assert.equal(asked.length, 1);
  }
}

// No exception shows a key, or the user and password of an address, whatever something between us and the service sends back.
const problem = { status: 403, code: "forbidden", detail: `no: ${ECHO}`, errors: [{ pointer: "", code: "", detail: ECHO }] };
const echoes: Said[] = [
  [403, `denied: ${ECHO}`], [403, "x".repeat(180) + ECHO], [403, JSON.stringify(problem)], `<p>${ECHO}</p>`,
  { raw: `denied ${ECHO}\r\n\r\n` }];
const withKey = new Facies(address, KEY, 5);
const withUser = new Facies(address.replace("://", `://somebody:${PASSWORD}@`), undefined, 5);
const isWithout = (...secrets: string[]) => (thrown: unknown) => {
  const shown = inspect(thrown, { depth: null });
  for (const secret of secrets) assert(!shown.includes(secret), shown);
  return thrown instanceof FaciesError;
};
for (const echo of echoes) {
  say(echo);
  await assert.rejects(withKey.run({} as Documents["JobDocument"]), isWithout(KEY, KEY.slice(0, 9)));
  assert.equal(asked.length, 1);
}
// `fetch` takes no address with a user, and says so with the address.
await assert.rejects(withUser.file(job, "skin.glb"), isWithout("somebody", "password"));
say({ raw: `denied ${ECHO}\r\n\r\n` });
const running = { id: job, status: "running" } as Documents["StatusInfo"];
await assert.rejects(ended(connect(address, KEY), running, 5), isWithout(KEY, KEY.slice(0, 9)));

// The same of the typed client.
say(undefined);
await assert.rejects(ended(connect(address), running, 5), isAway(job));
assert.deepEqual(pauses, [1, 2]);
for (const text of ["", "<html>bad gateway</html>", "[]"]) {
  say([502, text]);
  await assert.rejects(answered(connect(address).GET("/v1/cases")), (thrown) => thrown instanceof RefusedOfTyped
    && thrown.problem.status === 502 && thrown.problem.code === "not-of-the-service" && thrown.message.endsWith(`answered ${text}`));
}
server.closeAllConnections();
server.close();
console.log("a service that is away is waited for");
