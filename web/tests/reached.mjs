// Each view by keys alone, in both languages, light and dark, wide and narrow.
import assert from "node:assert/strict";
import { addressed, apart, check, fits, go, json, opened, pictured, planned, serious, address, caseId, plan } from "./tools.mjs";

/** Every view of the page by its address, those of results of all kinds among them. */
export async function allViews(job) {
  const newest = async (kind) => (await json(`/v1/jobs?kind=${kind}&status=successful&limit=1`)).items[0]?.id;
  const kinds = Object.fromEntries(await Promise.all(["optimise", "learn", "reproduce", "cohort", "conform", "response"].map(async (kind) => [kind, await newest(kind)])));
  const comparison = (await json(`/v1/jobs?kind=compare&status=successful&case=${caseId}&limit=1`)).items[0]?.id;
  const study = (await json("/v1/jobs?kind=study&status=successful&limit=1")).items[0]?.id;
  assert(Object.values({ ...kinds, comparison, study }).every((id) => id !== undefined), JSON.stringify({ ...kinds, comparison, study }));
  return { cases: "#/cases", case: `#/case/${caseId}`, plan: `${plan}?p=mandible,-4,0,0,0,0,0&view=1`, inverse: `#/case/${caseId}/inverse?targets=pogonion,3,1,0`,
    compare: `#/case/${caseId}/compare?job=${job}`, comparison: `#/case/${caseId}/compare?comparison=${comparison}`, plans: `#/case/${caseId}/plans`,
    result: `#/job/${job}?map=displacement&view=1&show=sides`, jobs: "#/jobs", studies: "#/studies", study: `#/studies?study=${study}`,
    ...Object.fromEntries(Object.entries(kinds).map(([kind, id]) => [kind, `#/job/${id}`])) };
}

/** Standard views by their keys, and the head turned by arrows, told by where the camera stands. */
export async function turned(page) {
  await page.locator(".screen canvas").focus();
  // Of a head that looks along LPS: to the patient's left, up, to the front.
  const direction = () => page.evaluate(() => { const { camera, controls } = document.querySelector(".screen").scene; return camera.position.clone().sub(controls.target).normalize().toArray(); });
  // An oblique view is halfway between the front and a side, the last one halfway to below.
  const half = Math.SQRT1_2;
  const wanted = { 1: [0, 0, 1], 2: [-1, 0, 0], 3: [1, 0, 0], 4: [-half, 0, half], 5: [half, 0, half], 6: [0, -half, half] };
  for (const [key, from] of Object.entries(wanted)) {
    await page.keyboard.press(key);
    assert(apart(await direction(), from) < (key < 4 ? 1e-6 : 0.1), `${key}: ${await direction()}`);
    assert.equal(await page.locator(".views [aria-pressed=true]").getAttribute("data-view"), key);
    await addressed(page, new RegExp(`view=${key}`));
  }
  // Both obliques are mirror images.
  await page.keyboard.press("4");
  const [left, up, front] = await direction();
  await page.keyboard.press("5");
  assert(apart(await direction(), [-left, up, front]) < 1e-6);
  await page.keyboard.press("3");
  await page.keyboard.press("ArrowLeft");
  assert(apart(await direction(), [1, 0, 0]) > 0.1);
}

async function arrived(page, name, path) {
  await go(page, path);
  await page.locator(".loading").waitFor({ state: "detached" });
  if (name === "plan") await planned(page);
  if (name === "case") await page.locator(".sets li").first().waitFor();
  if (name === "result" || name === "optimise") await page.locator("[data-share]").waitFor();
  if (name === "study") await page.locator(".chart .mark").first().waitFor();
}

/** More than any view has. */
const MOST_STOPS = 500;

/** Presses the tab key from one end of a view to the other: what can be done in it and is not reached, and what is reached and does not show
 * that it has the focus. */
async function tabbed(page) {
  await page.evaluate(() => {
    const controls = "button, a[href], input, select, textarea, summary, canvas, [tabindex='0']";
    const all = [...document.querySelectorAll(controls)].filter((one) => one.checkVisibility() && !one.disabled);
    all.forEach((one) => one.setAttribute("data-wanted", ""));
    addEventListener("focusin", ({ target }) => {
      target.removeAttribute("data-wanted");
      // Of radio buttons the chosen one is reached, and arrows choose the others.
      if (target.type === "radio") document.getElementsByName(target.name).forEach((one) => one.removeAttribute("data-wanted"));
    });
    // The head and foot of the page are those of the view before.
    document.querySelectorAll("[data-first]").forEach((one) => one.removeAttribute("data-first"));
    document.activeElement.blur();
  });
  const unseen = new Set();
  for (let press = 0; press < MOST_STOPS; press += 1) {
    await page.keyboard.press("Tab");
    // Once around: what came meanwhile was passed too.
    if (await page.evaluate((isFirst) => {
      const one = document.activeElement;
      if (isFirst) one.setAttribute("data-first", "");
      return !isFirst && one.hasAttribute("data-first");
    }, press === 0)) break;
    const fault = await page.evaluate(() => {
      const one = document.activeElement;
      if (one === document.body || one === null) return undefined;
      // A choice draws the word beside the button that nobody sees.
      const shown = one.matches(".choice input") ? one.nextElementSibling : one;
      const style = getComputedStyle(shown);
      const [width, offset] = [parseFloat(style.outlineWidth), parseFloat(style.outlineOffset)];
      const named = (why) => `${why}: ${one.outerHTML.slice(0, 100)}`;
      if (style.outlineStyle === "none" || width < 2) return named("no outline");
      const { left, right, top, bottom } = shown.getBoundingClientRect();
      const edges = { left: left - offset, right: right + offset, top: top - offset, bottom: bottom + offset };
      // The sides of the outline that nothing cuts off.
      let seen = ["left", "right", "top", "bottom"];
      for (let box = shown.parentElement; box !== null; box = box.parentElement) {
        if (box !== document.documentElement && getComputedStyle(box).overflow === "visible") continue;
        const clip = box === document.documentElement ? { left: 0, top: 0, right: innerWidth, bottom: innerHeight } : box.getBoundingClientRect();
        seen = seen.filter((side) => (side === "left" || side === "top" ? edges[side] >= clip[side] - 1 : edges[side] <= clip[side] + 1));
      }
      return seen.length >= 2 ? undefined : named(`${seen.length} sides of the outline are seen`);
    });
    if (fault !== undefined) unseen.add(fault);
  }
  const unreached = await page.evaluate(() => [...document.querySelectorAll("[data-wanted]")].map((one) => `not reached: ${one.outerHTML.slice(0, 100)}`));
  return [...unreached, ...unseen];
}

/** What the browser tells those who do not see the page: controls without a name. */
async function nameless(page) {
  const session = await page.context().newCDPSession(page);
  const { nodes } = await session.send("Accessibility.getFullAXTree");
  await session.detach();
  const is = (node, name) => node.properties?.some((one) => one.name === name && one.value.value === true) ?? false;
  // The view itself takes the focus after a link that leads to it, and is the main part.
  return nodes.filter((node) => !node.ignored && is(node, "focusable") && !["RootWebArea", "main"].includes(node.role.value) && (node.name?.value ?? "").trim() === "")
    .map((node) => `no name: ${node.role.value} ${JSON.stringify(node.value?.value ?? "")}`);
}

/** The list of jobs is seen whole, however long the name of a case is. */
async function listed(page) {
  const [is, most] = await page.locator(".scroll", { has: page.locator(".listed") }).evaluate((one) => [one.scrollWidth, one.clientWidth]);
  assert(is <= most, `jobs are ${is} px wide in ${most} px`);
}

export async function reached(views) {
  await check("German and dark, and at 390 pixels nothing is cut off", async () => {
    const small = await opened({ width: 390, height: 844 }, { locale: "de-DE", colorScheme: "dark", reducedMotion: "reduce" });
    for (const [name, path] of Object.entries(views)) {
      await arrived(small, name, path);
      assert.equal(await small.locator("html").getAttribute("lang"), "de");
      await fits(small);
      if (name === "jobs") await listed(small);
      assert.deepEqual(await serious(small), [], name);
      await pictured(small, `${name}-390-dark-german`);
    }
    const moving = await small.evaluate(() => [...document.querySelectorAll("*")].filter((one) => getComputedStyle(one).transitionDuration !== "0s" || getComputedStyle(one).animationName !== "none").length);
    assert.equal(moving, 0, "nothing moves for whoever asked for that");
    await small.context().close();
  });

  await check("each view has no serious fault of access, in both languages, light and dark", async () => {
    const faults = [];
    for (const [locale, language] of [["en-GB", "en"], ["de-DE", "de"]]) {
      // Colours that fade from light to dark are none of either.
      const wide = await opened(undefined, { locale, reducedMotion: "reduce" });
      for (const [name, path] of Object.entries(views)) {
        await arrived(wide, name, path);
        assert.equal(await wide.locator("html").getAttribute("lang"), language);
        for (const colorScheme of ["light", "dark"]) {
          await wide.emulateMedia({ colorScheme });
          faults.push(...(await serious(wide)).map((fault) => `${name} ${language} ${colorScheme}: ${fault}`));
          if (name === "jobs") await listed(wide);
          if (language === "en" || colorScheme === "dark") await pictured(wide, `${name}-1280-${colorScheme}-${language}`);
        }
      }
      await wide.context().close();
    }
    assert.equal(faults.length, 0, faults.join("\n"));
  });

  await check("each view by keyboard: what can be done is reached with the tab key, shows that it has the focus, and has a name", async () => {
    const wide = await opened();
    const faults = [];
    for (const [name, path] of Object.entries(views)) {
      await arrived(wide, name, path);
      // The tab says which view it is, and whoever followed a link by keys is in it.
      assert.match(await wide.title(), /.+ · facies$/, name);
      assert.equal(await wide.evaluate(() => document.activeElement.id), name === "cases" ? "" : "stage", name);
      faults.push(...[...await nameless(wide), ...await tabbed(wide)].map((fault) => `${name}: ${fault}`));
    }
    await wide.context().close();
    assert.equal(faults.length, 0, faults.join("\n"));
  });
}
