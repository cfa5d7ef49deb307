// Frames and memory by hand: `web/tests/drag [SECONDS [ORDER]]`.
import { browser, check, counted, ended, opened, service, caseId } from "./tools.mjs";
import { dragged, framed, slid } from "./frames.mjs";

const [seconds, order] = process.argv.slice(2).map(Number);
const page = await opened();
// It is there: nothing is solved beside what is measured.
await ended({ kind: "response", case: caseId, ...(order === 2 ? { order } : {}) });
await check("script of a slider's whole frame on a head of 14 000 nodes, linear and of second order", () => slid(page));
await check("frames of a large head", () => framed(page, 60));
await check(`memory over ${seconds} s of dragging on a response of order ${order}`, () => dragged(page, seconds, order));
await browser.close();
await service.stop();
process.exitCode = counted.failed === 0 ? 0 : 1;
