// A service of its own for a test: the built program, on a free port of this machine.
import { spawn } from "node:child_process";
import { mkdtemp, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

/** Starts `facies` with arguments and waits for the line that says where it is. */
export async function started(binary, args, line) {
  const folder = await mkdtemp(join(tmpdir(), "facies-page-"));
  const program = spawn(binary, args(folder), { stdio: ["ignore", "pipe", "inherit"] });
  const match = await new Promise((resolve, reject) => {
    program.once("exit", (code) => reject(new Error(`the service ended with ${code} before it said where it is`)));
    createInterface({ input: program.stdout }).on("line", (text) => {
      const found = line.exec(text);
      if (found !== null) resolve(found);
    });
  });
  const stop = async () => {
    const gone = new Promise((resolve) => { program.once("exit", resolve); });
    program.kill("SIGINT");
    await gone;
    await rm(folder, { recursive: true, force: true });
  };
  return { match, folder, stop };
}

export const demo = (binary) =>
  started(binary, (folder) => ["demo", "--serve", "--out", folder], /plan it yourself\s+(http:\/\/[^/]+)\/(#\/case\/([^/]+)\/plan)/);

export const guarded = (binary, key) =>
  started(binary, (folder) => ["serve", "--bind", "127.0.0.1:0", "--data", folder, "--api-key", key, "--free-space-floor-mib", "0", "--log-level", "error"],
    /listening on (http:\/\/\S+)/);
