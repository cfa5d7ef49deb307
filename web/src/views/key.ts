// The key of a service that asks for one; it is kept for this tab only.
import { make } from "../dom.js";
import type { Words } from "../words/en.js";

export function keyForm(words: Words, asked: (key: string) => void): HTMLElement {
  const input = make("input", { type: "password", name: "key", autocomplete: "off", required: true, minLength: 16 });
  const form = make("form", { className: "card key" },
    make("h1", {}, words.keyAsked), make("p", {}, words.keyWhy),
    make("label", { className: "field" }, make("span", {}, words.key), input),
    make("button", { className: "primary" }, words.goOn));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    asked(input.value.trim());
  });
  return form;
}
