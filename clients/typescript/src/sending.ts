// Requests on their way to the service: the header with its key, which no exception shows, and a file with its progress. `fetch`
// tells none in a browser, so that a page sends the file by XMLHttpRequest; elsewhere it goes as a stream, whose pieces are counted
// as they are taken.
import { NoKey } from "./errors.js";

/** How far a file is sent; `progress` goes from 0 to 100. */
export interface Upload {
  phase: "upload";
  sent_bytes: number;
  total_bytes: number;
  progress: number;
}
export type Uploading = (upload: Upload) => unknown;

const PIECE_BYTES = 1 << 16;

/** The header with a key, without the white space around it; throws `NoKey` where something in it cannot be in a header. */
export function authorization(key?: string): Record<string, string> {
  const given = (key ?? "").trim();
  if (!/^[!-~]*$/.test(given)) throw new NoKey();
  return given === "" ? {} : { Authorization: `Bearer ${given}` };
}

/** The user and the password in an address, wherever it is in a text. */
const USER = /:\/\/[^/?#\s]*@/g;
const OF_HTML: Record<string, string> = { "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#x27;" };

/** What no exception shows: a key, and the user and password of an address. */
export class Secrets {
  private readonly forms: string[];

  constructor(address: string, key?: string) {
    const written = /:\/\/[^/?#:]*:([^/?#]*)@/.exec(address)?.[1] ?? "";
    const secrets = [(key ?? "").trim(), written, changed(decodeURIComponent, written)].filter((secret) => secret !== "");
    // Also as HTML, JSON and addresses have them.
    const forms = secrets.flatMap((secret) => [
      secret, secret.replace(/[&<>"']/g, (letter) => OF_HTML[letter]!), JSON.stringify(secret).slice(1, -1),
      changed(encodeURIComponent, secret),
    ]);
    this.forms = forms.sort((one, other) => other.length - one.length);
  }

  /** A text, or a document with all its texts, with *** in place of secrets, and addresses without user and password. */
  hidden<T>(said: T): T {
    const of = (value: unknown): unknown => {
      if (typeof value === "string") return this.forms.reduce((text, form) => text.replaceAll(form, "***"), value.replace(USER, "://"));
      if (Array.isArray(value)) return value.map(of);
      if (typeof value !== "object" || value === null) return value;
      return Object.fromEntries(Object.entries(value).map(([name, member]) => [name, of(member)]));
    };
    return of(said) as T;
  }

  /** An exception and its causes, which show no secrets from then on. */
  hiddenIn(error: unknown): unknown {
    for (let one = error; one instanceof Error; one = one.cause) {
      // Its message and its stack, and whatever else `fetch` has put there.
      for (const name of Object.getOwnPropertyNames(one)) {
        const told: unknown = Reflect.get(one, name);
        if (typeof told === "string") Reflect.set(one, name, this.hidden(told));
      }
    }
    return error;
  }
}

/** A text after a change, or itself where it cannot be so changed. */
function changed(change: (text: string) => string, text: string): string {
  try {
    return change(text);
  } catch {
    return text;
  }
}

/** A request by the method POST whose body is a file. */
export interface Posted {
  address: string;
  headers: Record<string, string>;
  file: Blob;
}

/** The answer to a request; `uploading` is told of the file piece by piece. */
export function post(posted: Posted, uploading: Uploading): Promise<Response> {
  const { file } = posted;
  const tell = (sent: number) => {
    const progress = Math.floor((100 * sent) / Math.max(file.size, 1));
    uploading({ phase: "upload", sent_bytes: sent, total_bytes: file.size, progress });
  };
  return typeof XMLHttpRequest === "undefined" ? byStream(posted, tell) : byPage(posted, tell);
}

function byStream({ address, headers, file }: Posted, tell: (sent: number) => void): Promise<Response> {
  let sent = 0;
  const body = new ReadableStream<Uint8Array>({
    async pull(pieces) {
      if (sent === file.size) return pieces.close();
      const piece = await file.slice(sent, sent + PIECE_BYTES).arrayBuffer();
      pieces.enqueue(new Uint8Array(piece));
      sent += piece.byteLength;
      tell(sent);
    },
  });
  // A body that is a stream has to say that its answer comes afterwards, a member that types of `fetch` may not have.
  // The service sends no redirect, and the key is for no other one: it is an answer as a refusal is.
  const request = { method: "POST", headers, body, duplex: "half", redirect: "manual" } as RequestInit;
  return fetch(address, request);
}

function byPage({ address, headers, file }: Posted, tell: (sent: number) => void): Promise<Response> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", address);
    request.responseType = "blob";
    for (const [name, value] of Object.entries(headers)) request.setRequestHeader(name, value);
    request.upload.onprogress = ({ loaded }) => tell(loaded);
    request.onerror = () => reject(new TypeError("the service is out of reach"));
    request.onload = () => resolve(answer(request));
    request.send(file);
  });
}

/** What a page was answered, as `fetch` would hand it over. */
function answer(request: XMLHttpRequest): Response {
  const headers = new Headers();
  for (const line of request.getAllResponseHeaders().trim().split(/[\r\n]+/)) {
    const [name, ...value] = line.split(": ");
    if (name) headers.append(name, value.join(": "));
  }
  return new Response(request.response as Blob, { status: request.status, headers });
}
