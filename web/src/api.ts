// The service that this page came from: every call is noted, so that a person can repeat it.
import { Facies, type Documents } from "../../clients/typescript/src/facies.js";

export { FaciesError, JobFailed, NoKey, Refused, Unreachable, readGlb, type Documents, type Surface, type Triple } from "../../clients/typescript/src/facies.js";

export type Case = Documents["CaseView"];
export type Job = Documents["StatusInfo"];
export type Warning = Documents["WarningDocument"];
/** A case that has its mesh. */
export type CaseDocument = Documents["CaseDocument"];

/** The key lives as long as the tab. */
const KEY = "facies-key";
const MOST_CALLS = 50;
/** How long a service that is out of reach is waited for before a person is told. */
const AWAY_S = 3;

export interface Call {
  method: string;
  path: string;
  headers: Record<string, string>;
  body: BodyInit | undefined;
  /** The documents among the parts of a form, by their names. */
  documents?: Record<string, string>;
}

export class Service extends Facies {
  readonly calls: Call[] = [];
  /** Called with each call. */
  noted: (call: Call) => void = () => {};

  constructor() {
    super(location.origin, sessionStorage.getItem(KEY) ?? undefined, undefined, AWAY_S);
  }

  static keep(key: string): void {
    sessionStorage.setItem(KEY, key);
  }

  static forget(): void {
    sessionStorage.removeItem(KEY);
  }

  static get hasKey(): boolean {
    return sessionStorage.getItem(KEY) !== null;
  }

  override async ask(method: string, path: string, body?: BodyInit, headers: Record<string, string> = {}): Promise<Response> {
    this.note({ method, path, body, headers, ...(body instanceof FormData ? { documents: await documentsOf(body) } : {}) });
    return super.ask(method, path, body, headers);
  }

  override upload(...[mesh, units = "mm", frame = "unspecified", uploading]: Parameters<Facies["upload"]>): Promise<string> {
    // Without anybody to tell how far it is it goes by `ask`, which notes it.
    if (uploading !== undefined) {
      this.note({ method: "POST", path: `/v1/meshes?units=${units}&frame=${frame}`, body: mesh, headers: { "Content-Type": "application/octet-stream" } });
    }
    return super.upload(mesh, units, frame, uploading);
  }

  protected override follow(job: string): ReturnType<Facies["follow"]> {
    this.note({ method: "GET", path: `/v1/jobs/${job}/events`, headers: { Accept: "text/event-stream" }, body: undefined });
    return super.follow(job);
  }

  async get<Document>(path: string): Promise<Document> {
    return (await this.ask("GET", path, undefined, { Accept: "application/json" })).json() as Promise<Document>;
  }

  async post<Document>(path: string, document: unknown): Promise<Document> {
    const headers = { "Content-Type": "application/json", Accept: "application/json" };
    return (await this.ask("POST", path, JSON.stringify(document), headers)).json() as Promise<Document>;
  }

  /** All items of a list, a page after the other. */
  async list<Item>(path: string, most = 200): Promise<Item[]> {
    const items: Item[] = [];
    let cursor = "";
    do {
      const next: string = cursor === "" ? "" : `&cursor=${encodeURIComponent(cursor)}`;
      const page = await this.get<{ items: Item[]; next?: string }>(`${path}${path.includes("?") ? "&" : "?"}limit=50${next}`);
      items.push(...page.items);
      cursor = page.next ?? "";
    } while (cursor !== "" && items.length < most);
    return items;
  }

  private note(call: Call): void {
    this.calls.unshift(call);
    this.calls.length = Math.min(this.calls.length, MOST_CALLS);
    this.noted(call);
  }
}

async function documentsOf(form: FormData): Promise<Record<string, string>> {
  const parts = [...form.entries()].filter((part): part is [string, File] => part[1] instanceof File && part[1].type === "application/json");
  return Object.fromEntries(await Promise.all(parts.map(async ([name, part]) => [name, await part.text()] as const)));
}

const quoted = (text: string) => `'${text.replaceAll("'", `'\\''`)}'`;

/** A call as a person types it; the key is that of the variable FACIES_API_KEY. */
export function asCurl({ method, path, headers, body, documents = {} }: Call): string {
  const parts = ["curl -sS"];
  if (method !== "GET" && !(method === "POST" && body !== undefined)) parts.push(`-X ${method}`);
  for (const [name, value] of Object.entries(headers)) parts.push(`-H ${quoted(`${name}: ${value}`)}`);
  if (Service.hasKey) parts.push('-H "Authorization: Bearer $FACIES_API_KEY"');
  if (typeof body === "string") parts.push(`-d ${quoted(body)}`);
  const part = (name: string, value: FormDataEntryValue) => {
    const document = documents[name];
    // Within quotes curl takes what is between parts as it is.
    if (document !== undefined) return `${name}="${document.replaceAll(/["\\]/g, "\\$&")}";type=application/json`;
    return `${name}=@${value instanceof File ? value.name : name}`;
  };
  if (body instanceof FormData) parts.push(...[...body.entries()].map(([name, value]) => `-F ${quoted(part(name, value))}`));
  if (body instanceof Blob) parts.push(`--data-binary ${quoted(`@${body instanceof File ? body.name : "FILE"}`)}`);
  return [...parts, quoted(location.origin + path)].join(" ");
}
