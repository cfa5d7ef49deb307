// The views that draw in three dimensions, in one file that is fetched when the first of them is opened.
export { casePage } from "./case.js";
export { comparePage } from "./compare.js";
export { inversePage } from "./inverse.js";
export { planPage } from "./plan.js";
export { resultPage } from "./result.js";
export { plansPage } from "./stored.js";
export { boneOfScan, boneOfSurface, cutEditor } from "./cuts.js";
