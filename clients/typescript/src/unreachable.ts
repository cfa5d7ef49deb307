// What `Facies` does while a service is away: a server of its own breaks off and comes back, and no pause takes any time.
import { strict as assert } from "node:assert";
import { createServer } from "node:http";
import type { AddressInfo } from "node:net";
import { Facies, Refused, Unreachable, type Documents } from "./facies.js";
import { connect, ended } from "./index.js";
import { clock } from "./patience.js";

const job = "01890000-0000-7000-8000-000000000000";
const path = `/v1/jobs/${job}`;
const BREAKS = ": breaks\n\n";

// A clock that goes on by pauses alone.
let [now, pauses]: [number, number[]] = [0, []];
clock.now = () => now;
clock.sleep = async (seconds) => {
  pauses.push(seconds);
  now += seconds;
};

/** Lines of a stream, a status, or `undefined` for a closed connection. */
type Said = string | number | undefined;
let said: Said[] = [];
const asked: (string | undefined)[] = [];
const server = createServer((request, answer) => {
  request.resume();
  asked.push(request.headers["last-event-id"] as string | undefined);
  const next = said.length > 1 ? said.shift() : said[0];
  if (next === undefined) return void request.socket.destroy();
  const lines = typeof next === "string" ? next : "";
  // A stream that has not all that it promises breaks.
  const promised = lines.length + (lines.endsWith(BREAKS) ? 9 : 0);
  answer.writeHead(typeof next === "number" ? next : 200, next === 204 ? {} : { "Content-Length": promised });
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

// The same of the typed client.
say(undefined);
await assert.rejects(ended(connect(address), { id: job, status: "running" } as Documents["StatusInfo"], 5), isAway(job));
assert.deepEqual(pauses, [1, 2]);
server.closeAllConnections();
server.close();
console.log("a service that is away is waited for");
