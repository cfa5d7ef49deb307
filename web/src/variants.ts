// Variants of methods in the words of the service's charts: the tables are those of src/jobs/study/words.rs.

const METHODS: Record<string, string> = {
  auto: "chosen by its error", fem_linear: "linear FEM", fem_nonlinear: "nonlinear FEM", mtm: "mass-tensor", mtm_ti: "mass-tensor with fibres",
  mtm_nonlinear: "nonlinear mass-tensor", msm: "springs", dvs: "spline", thickness_warp: "warp that keeps thickness",
};

const VARIANTS: Record<string, string> = {
  gauss_seidel: "Gauss-Seidel", damped_jacobi: "damped Jacobi", jacobi: "Jacobi", newton: "Newton", direct: "node by node", galerkin: "Galerkin",
  lattice: "lattice of links",
};

const words = (text: string) => text.replaceAll("_", " ");

/** A variant by the label of its rows; labels of clients are taken for words. */
export function variantInWords(label: string): string {
  const [name = "", ...parts] = label.split(" ");
  const rest = parts.join(" ");
  const method = METHODS[name];
  if (method === undefined) return words(label);
  return rest === "" ? method : `${method}, ${VARIANTS[rest] ?? words(rest)}`;
}
