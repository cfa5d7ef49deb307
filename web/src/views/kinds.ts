// Kinds and states of jobs in words.
import type { Words } from "../words/en.js";

export const kindOf = (words: Words, kind: string): string => words.kinds[kind] ?? kind;
export const statusOf = (words: Words, status: string): string => words.statuses[status] ?? status;
