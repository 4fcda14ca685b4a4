"use strict";
const byId = (id) => document.getElementById(id);
const SVG = "http://www.w3.org/2000/svg";
const LEAST_MS = 60;
const SETTLE_MS = 1500; // A switch keeps what was pressed for so long, until the bench has heard of it.
let state = null, lost = 0, shownViews = 0, switched = -SETTLE_MS;
const drawn = {};

// The token is in the cookie now; it need not stay in the address and its history.
history.replaceState(null, "", "/");

const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

async function ask(path) {
  const answer = await fetch(path, {cache: "no-store", credentials: "same-origin"});
  if (!answer.ok) throw new Error(String(answer.status));
  return answer;
}

function heard(works) {
  lost = works ? 0 : lost + 1;
  byId("lost").hidden = lost < 3 || ended();
}
const ended = () => state !== null && (state.phase === "done" || state.phase === "failed");

async function send(command, view = "") {
  try {
    await fetch("/wishes", {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify({command, view})});
    if (command === "close") closed();
  } catch { heard(false); }
}

function closed() {
  byId("bar").hidden = true;
  byId("request").textContent = "Done. You can close this window.";
  byId("hint").textContent = "";
  document.querySelectorAll("[data-command]").forEach((button) => { button.disabled = true; });
}

function made(tag, name, parent) {
  const one = document.createElementNS(SVG, tag);
  one.setAttribute("class", name);
  parent.append(one);
  return one;
}

function figure(camera) {
  if (drawn[camera.name]) return drawn[camera.name];
  const one = {root: document.createElement("figure"), frame: document.createElement("div"), canvas: document.createElement("canvas"),
    svg: document.createElementNS(SVG, "svg"), name: document.createElement("b"), status: document.createElement("span"), number: 0, times: []};
  one.root.className = "camera";
  one.frame.className = "frame";
  one.canvas.setAttribute("role", "img");
  one.canvas.setAttribute("aria-label", `Live picture of the camera ${camera.name}`);
  one.svg.setAttribute("aria-hidden", "true");
  one.status.className = "status";
  one.name.textContent = camera.name;
  const caption = document.createElement("figcaption");
  caption.append(one.name, one.status);
  one.map = document.createElementNS(SVG, "svg");
  one.map.setAttribute("class", "map");
  one.map.setAttribute("role", "img");
  one.map.setAttribute("aria-label", `Parts of the picture of ${camera.name} in which dots were found so far`);
  caption.append(one.map);
  one.frame.append(one.canvas, one.svg);
  one.root.append(one.frame, caption);
  byId("cameras").append(one.root);
  drawn[camera.name] = one;
  pictures(camera.name, one);
  return one;
}

async function pictures(name, one) {
  for (;;) {
    const began = performance.now();
    if (state.phase === "done" || document.hidden) { await sleep(500); continue; }
    try {
      const answer = await ask(`/pictures/${encodeURIComponent(name)}?after=${one.number}`);
      if (answer.status === 204) { await sleep(200); continue; }
      const number = Number(answer.headers.get("X-Number"));
      if (number !== one.number) {
        const picture = await createImageBitmap(await answer.blob());
        one.canvas.width = picture.width;
        one.canvas.height = picture.height;
        one.canvas.getContext("2d").drawImage(picture, 0, 0);
        picture.close();
        one.number = number;
        one.times = [...one.times.slice(-30), performance.now()];
      }
      heard(true);
      await sleep(Math.max(0, LEAST_MS - (performance.now() - began)));
    } catch { heard(false); await sleep(700); }
  }
}
// Pictures a second of a camera, for tests.
window.rate = (name) => { const t = drawn[name].times; return t.length < 3 ? 0 : 1000 * (t.length - 1) / (t[t.length - 1] - t[0]); };

function overlay(camera) {
  const one = figure(camera), [width, height] = camera.size;
  if (!width) return;
  one.frame.style.aspectRatio = `${width} / ${height}`;
  one.svg.setAttribute("viewBox", `-0.5 -0.5 ${width} ${height}`);
  one.svg.replaceChildren();
  const unit = width / 400, aiming = state.phase === "aim" || state.phase === "take";
  coverage(one, camera.coverage, width / height);
  if (!aiming) return;
  camera.dots.forEach(([x, y]) => {
    const dot = made("circle", "dot", one.svg);
    dot.setAttribute("cx", x); dot.setAttribute("cy", y); dot.setAttribute("r", 1.6 * unit); dot.setAttribute("stroke-width", .9 * unit);
  });
  if (camera.outline.length) for (const name of ["outline-under", "outline"]) {
    const line = made("polygon", name, one.svg);
    line.setAttribute("points", camera.outline.map((q) => q.join(",")).join(" "));
    line.setAttribute("vector-effect", "non-scaling-stroke");
  }
}

function coverage(one, rows, ratio) {
  const key = JSON.stringify(rows), columns = rows.length ? rows[0].length : 0;
  if (key === one.covered) return;
  one.covered = key;
  one.map.replaceChildren();
  one.map.toggleAttribute("hidden", columns === 0);
  if (!columns) return;
  const high = 10 * columns / ratio / rows.length;
  one.map.setAttribute("viewBox", `0 0 ${10 * columns} ${high * rows.length}`);
  rows.forEach((row, j) => row.forEach((count, i) => {
    const cell = made("rect", count ? "cell full" : "cell", one.map);
    for (const [name, value] of Object.entries({x: 10 * i + .5, y: high * j + .5, width: 9, height: high - 1})) cell.setAttribute(name, value);
  }));
}

function list(id, texts) {
  const card = byId(id);
  card.hidden = texts.length === 0;
  card.querySelector("ul").replaceChildren(...texts.map((text) => Object.assign(document.createElement("li"), {textContent: text})));
}

// The list of views is built again only when it has changed, so that a button stays while it is pressed.
let listed = "";
function views(taken, aiming) {
  const key = JSON.stringify([taken, aiming]);
  if (key === listed) return;
  listed = key;
  byId("taken").querySelector("ul").replaceChildren(...taken.map((one) => {
    const line = document.createElement("li"), button = document.createElement("button");
    button.type = "button";
    button.className = "small";
    button.textContent = "Take out";
    button.disabled = !aiming;
    button.setAttribute("aria-label", `Take out ${one.name}`);
    button.addEventListener("click", () => {
      if (button.dataset.sure) { button.disabled = true; send("drop", one.name); return; }
      button.dataset.sure = "1";
      button.textContent = "Delete it?";
      setTimeout(() => { delete button.dataset.sure; button.textContent = "Take out"; }, 4000);
    });
    line.append(Object.assign(document.createElement("b"), {textContent: one.name}), " ", button,
      ...one.remarks.map((text) => Object.assign(document.createElement("p"), {textContent: text, className: "quiet"})));
    return line;
  }));
}

function pairs(id, entries) {
  byId(id).replaceChildren(...entries.flatMap(([name, value]) => [
    Object.assign(document.createElement("dt"), {textContent: name}), Object.assign(document.createElement("dd"), {textContent: value})]));
}

const millimetres = (value) => `${value < 0.1 ? value.toFixed(3) : value < 10 ? value.toFixed(2) : value.toFixed(1)} mm`;

function show() {
  const aiming = state.phase === "aim", taking = state.phase === "take", few = state.views < state.least_views;
  document.body.dataset.phase = state.phase;
  document.body.dataset.views = state.views;
  byId("request").textContent = state.request;
  byId("hint").textContent = state.hint;
  byId("guided").hidden = !state.guided;
  byId("unguided").hidden = state.guided || state.phase === "start";
  byId("fill").hidden = !state.guided;
  byId("step").textContent = {start: "Preparing", aim: state.request.startsWith("View") ? "" : `View ${state.views + 1}${state.wanted_views ? ` of ${state.wanted_views}` : ""}`,
    take: `View ${state.views + 1}`, calibrate: "Calibrating", done: "Calibrated", failed: "Stopped"}[state.phase];
  byId("cameras").hidden = state.phase === "done" || state.phase === "calibrate" || state.phase === "failed";
  byId("cameras").classList.toggle("several", state.cameras.length > 1);
  byId("cameras").classList.toggle("many", state.cameras.length > 2);
  for (const camera of state.cameras) {
    overlay(camera);
    const one = drawn[camera.name];
    one.root.classList.toggle("found", camera.found === true);
    one.status.textContent = camera.found === null ? (aiming || taking ? "looking for the target …" : "") : camera.found ? (state.still ? "target found, still" : "target found") : "target not found";
  }
  byId("meter").hidden = state.reached_mm === null || state.phase === "failed" || state.phase === "done";
  if (state.reached_mm !== null) {
    byId("reached").textContent = millimetres(state.reached_mm);
    byId("wanted").textContent = state.wanted_mm === null ? "" : `wanted: ${millimetres(state.wanted_mm)}`;
    byId("means").textContent = state.findings.length ? "Not to be believed yet: see what is wrong below" : "typical error of a measured point";
    byId("meter").classList.toggle("reached", state.wanted_mm !== null && state.reached_mm <= state.wanted_mm);
  }
  if (state.views > 0 && byId("views").textContent === "0") byId("help").open = false;
  byId("views").textContent = state.views;
  byId("views-label").textContent = state.views === 1 ? "view" : "views";
  if (state.views > shownViews && shownViews >= 0) {
    document.body.classList.add("flash");
    setTimeout(() => document.body.classList.remove("flash"), 350);
  }
  shownViews = state.views;
  byId("take").disabled = !aiming || state.ended;
  byId("take").textContent = taking ? "Looking …" : "Take";
  byId("undo").disabled = !aiming || state.views === 0;
  byId("taken").hidden = !(aiming || taking) || state.taken.length === 0;
  views(state.taken, aiming);
  byId("notice").hidden = !state.notice || !(aiming || taking);
  byId("notice").textContent = state.notice;
  const refused = state.faults.length > 0 && state.faults[0].startsWith("Not taken");
  byId("refused").hidden = !refused;
  byId("faults-head").textContent = refused ? "This view was refused" : "The last view";
  byId("finish").disabled = !(aiming || taking) || few;
  byId("finish").title = few ? `At least ${state.least_views} views are needed` : "";
  byId("finish").classList.toggle("primary", state.enough && !few);
  byId("take").classList.toggle("primary", !(state.enough && !few));
  if (performance.now() - switched > SETTLE_MS) byId("auto").checked = state.auto;
  byId("auto").disabled = state.ended;
  byId("bar").hidden = !(aiming || taking);
  byId("help").hidden = !(aiming || taking || state.phase === "start");
  byId("error").hidden = !state.error;
  byId("error").textContent = state.error;
  list("faults", aiming || taking ? state.faults : []);
  list("findings", state.findings);
  list("lacks", aiming || taking ? state.lacks : []);
  byId("work").hidden = state.phase !== "calibrate";
  if (state.work) {
    const [label, done, total] = state.work;
    byId("work-label").textContent = label;
    if (total) byId("work-bar").value = done / total; else byId("work-bar").removeAttribute("value");
  }
  byId("outcome").hidden = state.phase !== "done" || state.outcome === null;
  if (state.outcome) {
    byId("sentence").textContent = state.outcome.sentence;
    pairs("figures", state.outcome.figures);
    pairs("files", state.outcome.files);
    byId("next").textContent = state.outcome.next_step;
    byId("warnings").replaceChildren(...state.outcome.warnings.map((text) => Object.assign(document.createElement("p"), {textContent: text, className: "card warn"})));
  }
}

async function states() {
  let number = 0;
  for (;;) {
    try {
      const answer = await ask(`/state?after=${number}`);
      state = await answer.json();
      heard(true);
      if (state.number !== number) { number = state.number; show(); }
      await sleep(40);
    } catch { heard(false); await sleep(700); }
  }
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("button[data-command]");
  if (button && !button.disabled) send(button.dataset.command);
});
byId("undo").addEventListener("click", () => {
  const last = state.taken[state.taken.length - 1];
  if (last) send("drop", last.name);
});
byId("auto").addEventListener("change", (event) => {
  switched = performance.now();
  send(event.target.checked ? "auto" : "by-hand");
});
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.repeat || event.target.closest("button, input, a, summary")) return;
  const press = {" ": "take", f: "finish", F: "finish", a: "auto", A: "auto", u: "undo", U: "undo"}[event.key];
  if (!press) return;
  event.preventDefault();
  byId(press).click();
});
states();
