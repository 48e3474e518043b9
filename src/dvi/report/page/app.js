"use strict";
// Shared by the views: the data, functions that make elements, and the current view, which is the part of the address after #:
// #overview, #frames/12, #above, #stages.
const dvi = {
  views: {},  // by the id of its section: {title, start(), show(argument), key(event)}; filled by the files of the views
  data: null, // from index.js: write_report() in report.cpp
  started: new Set(),
};

/** An element with properties and children; text is never interpreted as HTML. */
dvi.element = (tag, properties = {}, ...children) => {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
};

dvi.svg = (tag, attributes = {}, ...children) => {
  const node = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
};

dvi.byId = (id) => document.getElementById(id);
dvi.percent = (share, digits = 1) => (Number.isFinite(share) ? (100 * share).toFixed(digits) + " %" : "–");
dvi.number = (value, digits = 1) => (Number.isFinite(value) ? value.toFixed(digits) : "–");
dvi.numbered = (folder, number, ending) => `report/${folder}${String(number).padStart(6, "0")}${ending}`;

/** The frames in the report of the run: name, number, hole, and so on. */
dvi.frames = () => dvi.data.run.frames || [];

/** The name of a frame, after its camera if the result has several. */
dvi.frameName = (frame) => {
  const entry = dvi.frames()[frame] || {};
  return entry.camera ? `${entry.camera}/${entry.name}` : entry.name;
};

/** The first and the last frame of the camera of a frame. */
dvi.cameraRange = (frame) => {
  const camera = (dvi.frames()[frame] || {}).camera;
  const first = dvi.frames().findIndex((entry) => entry.camera === camera);
  return [first, dvi.frames().findLastIndex((entry) => entry.camera === camera)];
};

/** The drive, camera, and frame of a source number; null if sources.json is missing. */
dvi.source = (number) => {
  const found = dvi.data.sources[number];
  if (!found) return null;
  const [drive, camera, name] = found;
  const [ownDrive, ownCamera] = dvi.data.sources[0];
  const isSource = (frame) => frame.name === name && (frame.camera || ownCamera) === camera;
  return {drive, camera, name, frame: drive === ownDrive ? dvi.frames().findIndex(isSource) : -1};
};

/** An enlarged part of a frame: pictures are drawn over each other, with crosshairs at `mark`. Integers are pixel centers. */
dvi.crop = (pictures, size, part, mark) => {
  const [x, y, width, height] = part;
  const svg = dvi.svg("svg", {viewBox: `${x} ${y} ${width} ${height}`, class: "crop", role: "img"});
  for (const picture of pictures) {
    const image = dvi.svg("image", {href: picture, width: size[0], height: size[1], preserveAspectRatio: "none"});
    image.addEventListener("error", () => svg.dispatchEvent(new CustomEvent("gone", {detail: picture})));
    svg.append(image);
  }
  if (mark) {
    const [mx, my] = [mark[0] + 0.5, mark[1] + 0.5];
    const gap = height / 30, arm = height / 6;
    for (const className of ["cross-edge", "cross"])
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]])
        svg.append(dvi.svg("line", {class: className, x1: mx + gap * dx, y1: my + gap * dy, x2: mx + arm * dx, y2: my + arm * dy}));
  }
  return svg;
};

/** The pictures of a frame as it was recorded. */
dvi.before = (frame) => {
  const entry = dvi.data.frames[frame];
  return entry.before ? [entry.picture, dvi.numbered("before/", frame, ".png")] : [entry.picture];
};

dvi.go = (view, argument) => {
  const hash = argument === undefined ? `#${view}` : `#${view}/${argument}`;
  if (location.hash === hash) dvi.route();
  else location.hash = hash;
};

dvi.shown = () => location.hash.slice(1).split("/")[0] in dvi.views ? location.hash.slice(1).split("/")[0] : "overview";

dvi.route = () => {
  const name = dvi.shown();
  const argument = location.hash.split("/")[1];
  for (const [id, view] of Object.entries(dvi.views)) {
    dvi.byId(id).hidden = id !== name;
    view.tab.classList.toggle("here", id === name);
    if (id !== name && view.hide) view.hide();
  }
  if (!dvi.started.has(name)) {
    dvi.started.add(name);
    dvi.views[name].start();
  }
  if (dvi.views[name].show) dvi.views[name].show(argument);
};

/** Called by index.js. */
dvi.index = (data) => {
  dvi.data = data;
  dvi.byId("broken").remove();
  const drive = ((data.run.drives || [])[0] || {}).path;
  const name = drive ? drive.split("/").pop() : data.title;
  document.title = `${name} – dvi`;
  dvi.byId("title").textContent = name;
  for (const [id, view] of Object.entries(dvi.views)) {
    view.tab = dvi.element("a", {href: `#${id}`, textContent: view.title});
    dvi.byId("tabs").append(view.tab);
  }
  window.addEventListener("hashchange", dvi.route);
  document.addEventListener("keydown", (event) => {
    if (event.target.matches("select, input, textarea") || event.ctrlKey || event.metaKey || event.altKey) return;
    const view = dvi.views[dvi.shown()];
    if (view.key && view.key(event)) event.preventDefault();
  });
  dvi.route();
};
