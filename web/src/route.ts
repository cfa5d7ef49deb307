// The state of the page, as it stands in its address: #/case/ID/plan?p=...

export interface Route {
  path: string[];
  state: URLSearchParams;
}

export function read(hash: string): Route {
  const [path = "", state = ""] = hash.replace(/^#\/?/, "").split("?", 2);
  return { path: path.split("/").filter((part) => part !== ""), state: new URLSearchParams(state) };
}

export function address(path: string[], state: Record<string, string | undefined> = {}): string {
  const set = Object.entries(state).filter((entry): entry is [string, string] => entry[1] !== undefined && entry[1] !== "");
  const query = new URLSearchParams(set).toString();
  return `#/${path.map(encodeURIComponent).join("/")}${query === "" ? "" : `?${query}`}`;
}

/** Changes a part of the state without a step to go back to. */
export function note(changes: Record<string, string | undefined>): void {
  const route = read(location.hash);
  const state = { ...Object.fromEntries(route.state), ...changes };
  history.replaceState(null, "", address(route.path.map(decodeURIComponent), state));
}
