"use strict";
// One frame: before and after with a divider, overlays, play, and the strip of all frames.
(() => {
  const e = dvi.element, t = dvi.texts, id = dvi.byId;
  const state = {frame: 0, share: 0.5, overlay: "none", compare: "before", look: null, timer: null, mark: null};
  let map, strip, layers = {};

  const size = () => dvi.data.frames[state.frame].size || [1, 1];
  const bounds = ([width, height]) => [[-height, 0], [0, width]];
  const last = () => dvi.frames().length - 1;
  const range = () => dvi.cameraRange(state.frame);

  // ---- pictures
  const place = (name, picture, pane) => {
    if (layers[name]) layers[name].remove();
    layers[name] = picture ? L.imageOverlay(picture, bounds(size()), {pane, className: "pixels"}).addTo(map) : null;
  };

  // Keeps the last picture until the next one is decoded, so that a film does not flash.
  const swap = (name, picture, pane) => {
    const layer = layers[name];
    if (!layer || !picture) return place(name, picture, pane);
    layer.setUrl(picture).setBounds(L.latLngBounds(bounds(size())));
  };

  const clip = () => {
    const corner = map.containerPointToLayerPoint([0, 0]), end = map.containerPointToLayerPoint(map.getSize());
    const x = corner.x + map.getSize().x * state.share;
    map.getPane("left").style.clip = `rect(${corner.y}px, ${x}px, ${end.y}px, ${corner.x}px)`;
    id("divider").style.left = `${100 * state.share}%`;
    id("left-tag").hidden = state.share < 0.08;
    id("right-tag").hidden = state.share > 0.92;
  };

  const leftPicture = () => {
    const entry = dvi.data.frames[state.frame];
    if (state.compare === "truth") return entry.truth ? dvi.numbered("truth/", state.frame, ".png") : null;
    return entry.before ? dvi.numbered("before/", state.frame, ".png") : null;
  };

  // ---- overlays: cividis, which color-blind people can read
  const ramp = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];
  const rampAt = (share) => {
    const at = Math.max(0, Math.min(0.9999, share)) * (ramp.length - 1), low = Math.floor(at);
    return ramp[low].map((c, i) => c + (ramp[low + 1][i] - c) * (at - low));
  };
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  const kindColors = t.kinds.map((kind) => (kind.color ? rgb(kind.color) : [0, 0, 0]));

  const colorOf = {
    mask: () => () => [213, 94, 0],
    kind: (block) => (k) => kindColors[block.kind[block.hole[k]]],
    confidence: (block) => block.fields.confidence && ((k) => rampAt(block.fields.confidence[k] / 255)),
    depth: (block) => {
      const depth = block.fields.depth;
      if (!depth) return null;
      const known = Array.from(depth).filter((z) => z > 0).sort((a, b) => a - b);
      const low = Math.log(known[Math.floor(known.length * 0.02)] || 1), high = Math.log(known[Math.floor(known.length * 0.98)] || 2);
      return (k) => (depth[k] ? rampAt((Math.log(depth[k]) - low) / (high - low || 1)) : null);
    },
    blending: (block) => {
      const channels = ["red", "green", "blue"].map((name) => block.fields[name]);
      if (!channels[0]) return null;
      return (k) => (block.fields.source[k] ? rampAt(Math.max(...channels.map((c) => Math.abs(c[k] - 32768))) / 40) : null);
    },
    error: (block) => block.fields.error && ((k) => rampAt(block.fields.error[k] / 64)),
  };

  const drawOverlay = async () => {
    const frame = state.frame, name = state.overlay;
    const ask = `${frame} ${name}`;
    state.asked = ask;
    if (name === "none") return showOverlay(null, ask);
    let block;
    try {
      block = await dvi.receipts(frame);
    } catch (error) {
      if (state.asked !== ask) return;
      showOverlay(null, ask);
      dvi.noReceipt(`${error.message}: no overlay and no provenance.`);
      return;
    }
    if (state.asked !== ask) return;
    const color = colorOf[name](block);
    if (!color) return showOverlay(null, ask);
    const canvas = e("canvas", {width: block.width, height: block.height});
    const context = canvas.getContext("2d"), image = context.createImageData(block.width, block.height);
    for (let k = 0; k < block.hole.length; ++k) {
      const c = color(k), at = 4 * block.hole[k];
      if (c) [image.data[at], image.data[at + 1], image.data[at + 2], image.data[at + 3]] = [...c, 215];
    }
    context.putImageData(image, 0, 0);
    showOverlay(canvas, ask);
  };

  const showOverlay = (canvas, ask) => {
    if (state.asked !== ask) return;
    if (layers.overlay) layers.overlay.remove();
    // Leaflet accepts any element as an SVG overlay.
    layers.overlay = canvas ? L.svgOverlay(canvas, bounds(size()), {pane: "overlay", className: "pixels"}).addTo(map) : null;
    id("picture").dataset.overlay = state.overlay;
    legend();
  };

  const legend = () => {
    const overlay = t.overlays.find((o) => o.name === state.overlay);
    const swatch = (color, text, hint) => e("span", {className: "entry", title: hint || ""}, e("i", {className: "swatch", style: `background:${color}`}), text);
    const node = id("legend");
    if (overlay.name === "none") node.replaceChildren(e("span", {className: "hint", textContent: "No overlay. Drag the divider to compare."}));
    else if (overlay.name === "mask") node.replaceChildren(swatch("#d55e00", "removed"));
    else if (overlay.name === "kind") node.replaceChildren(...t.kinds.filter((k) => k.color).map((k) => swatch(k.color, k.name, k.hint)));
    else node.replaceChildren(e("span", {textContent: overlay.low}),
      e("i", {className: "ramp", style: `background:linear-gradient(90deg, ${ramp.map((c) => `rgb(${c})`).join(",")})`}), e("span", {textContent: overlay.high}));
  };

  // ---- selection of the view
  const fit = () => map.fitBounds(bounds(size()), {animate: false});
  const lookNow = (part) => map.fitBounds([[-part[1] - part[3], part[0]], [-part[1], part[0] + part[2]]], {animate: false});

  // The strip shows the frames of one camera.
  const updateStrip = () => {
    const camera = dvi.frames()[state.frame].camera;
    if (strip && camera === state.stripCamera) return strip.update("none");
    if (strip) strip.destroy();
    state.stripCamera = camera;
    strip = dvi.shareStrip(id("strip"), () => state.frame);
  };

  const show = (frame) => {
    const before = size().join();
    if (frame !== state.frame) dvi.noReceipt(t.receipt);
    state.frame = Math.max(0, Math.min(last(), frame));
    const entry = dvi.data.frames[state.frame], report = dvi.frames()[state.frame];
    const [first, end] = range();
    id("frame-name").textContent = `${report.name}  (${state.frame - first + 1} of ${end - first + 1})`;
    id("camera").value = report.camera || "";
    if (entry.missing.length) dvi.noReceipt(`Missing in this result: ${entry.missing.join(", ")}. Run the same command again to complete it.`);
    swap("after", entry.size ? entry.picture : null, "right");
    swap("base", entry.size ? entry.picture : null, "base");
    swap("patch", entry.size ? leftPicture() : null, "left");
    if (state.mark) state.mark = void state.mark.remove();
    if (state.look) lookNow(state.look);
    else if (before !== size().join() || !state.fitted) fit();
    state.fitted = true;
    state.look = null;
    clip();
    drawOverlay();
    updateStrip();
    const ahead = dvi.data.frames[state.frame + 1];
    if (ahead && ahead.size) [ahead.picture, dvi.numbered("before/", state.frame + 1, ".png")].forEach((src) => { new Image().src = src; });
  };

  const go = (frame) => dvi.go("frames", Math.max(0, Math.min(last(), frame)));
  const goWithin = (frame) => go(Math.max(range()[0], Math.min(range()[1], frame)));

  // To the frame of another camera with the same number, or else with the same place among the camera's frames.
  const goToCamera = (camera) => {
    const number = dvi.frames()[state.frame].number;
    const same = dvi.frames().findIndex((frame) => frame.camera === camera && frame.number === number);
    const first = dvi.frames().findIndex((frame) => frame.camera === camera);
    const [, end] = dvi.cameraRange(first);
    go(same >= 0 ? same : Math.min(end, first + state.frame - range()[0]));
  };

  const stop = () => {
    clearTimeout(state.timer);
    state.timer = null;
    id("play").textContent = "Play";
  };
  const step = () => {
    if (state.timer === null) return;
    const image = layers.after && layers.after.getElement();
    if (image && !image.complete) return void (state.timer = setTimeout(step, 20));  // a slow disk
    const [first, end] = range();
    const next = state.frame < end ? state.frame + 1 : first;
    history.replaceState(null, "", `#frames/${next}`);
    show(next);
    state.timer = setTimeout(step, 100);
  };
  const play = () => {
    if (state.timer !== null) return stop();
    id("play").textContent = "Stop";
    state.timer = setTimeout(step, 0);
  };

  // The worst tenth of the frames, and only the worst of neighboring frames.
  const badFrames = () => dvi.worstFrames(Math.max(3, Math.ceil(dvi.data.frames.length / 10))).sort((a, b) => a - b);
  const toBad = (direction) => {
    const list = badFrames();
    const next = direction > 0 ? list.find((i) => i > state.frame) : list.filter((i) => i < state.frame).pop();
    const frame = next !== undefined ? next : direction > 0 ? list[0] : list[list.length - 1];
    if (frame === undefined) return;
    state.look = dvi.data.frames[frame].worst;
    go(frame);
  };

  const setOverlay = (name) => {
    if (!t.overlays.some((o) => o.name === name && (!o.truth || dvi.data.evaluation))) return;
    state.overlay = name;
    id("overlay").value = name;
    drawOverlay();
  };

  const clicked = async (event) => {
    const x = Math.floor(event.latlng.lng), y = Math.floor(-event.latlng.lat), [width, height] = size();
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    stop();
    if (state.mark) state.mark.remove();
    state.mark = L.rectangle([[-y - 1, x], [-y, x + 1]], {pane: "mark", weight: 2, color: "#ffffff", fill: false, interactive: false, className: "mark"}).addTo(map);
    const frame = state.frame;
    try {
      const block = await dvi.receipts(frame);
      dvi.showReceipt(frame, x, y, block.at(x, y));
    } catch (error) {
      dvi.noReceipt(`${error.message}: there is no provenance.`);
    }
  };

  const drag = (event) => {
    const box = id("picture").getBoundingClientRect();
    const move = (at) => {
      state.share = Math.max(0, Math.min(1, (at.clientX - box.left) / box.width));
      clip();
    };
    const end = () => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", end);
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", end);
    event.preventDefault();
    event.stopPropagation();
  };

  const makeMap = () => {
    map = L.map("picture", {crs: L.CRS.Simple, zoomSnap: 0, zoomDelta: 0.5, minZoom: -4, maxZoom: 6, attributionControl: false, keyboard: false, zoomAnimation: false, fadeAnimation: false, inertia: false});
    [["right", 300], ["left", 310], ["overlay", 320], ["mark", 330]].forEach(([name, z]) => { map.createPane(name).style.zIndex = z; });
    map.createPane("base").style.zIndex = 290;
    map.getPane("left").style.pointerEvents = map.getPane("overlay").style.pointerEvents = "none";
    map.setView([0, 0], 0);
    map.on("move zoomend resize viewreset", clip);
    map.on("click", clicked);
    new ResizeObserver(() => map.invalidateSize({animate: false})).observe(id("picture"));
    dvi.frameView.map = map;
  };

  const makeControls = () => {
    id("keys").textContent = t.keys;
    const withTruth = Boolean(dvi.data.evaluation);
    id("overlay").append(...t.overlays.filter((o) => !o.truth || withTruth).map((o) => e("option", {value: o.name, textContent: `${o.title} (${o.key})`})));
    id("compare").append(e("option", {value: "before", textContent: "before"}), withTruth ? e("option", {value: "truth", textContent: "truth"}) : "");
    id("compare-label").hidden = !withTruth;
    id("overlay").onchange = (event) => setOverlay(event.target.value);
    id("compare").onchange = (event) => {
      state.compare = id("left-tag").textContent = event.target.value;
      show(state.frame);
    };
    id("left-tag").textContent = "before";
    const cameras = [...new Set(dvi.frames().map((frame) => frame.camera || ""))];
    id("camera").append(...cameras.map((camera) => e("option", {value: camera, textContent: camera})));
    id("camera-label").hidden = cameras.length < 2;
    id("camera").onchange = (event) => goToCamera(event.target.value);
    id("previous").onclick = () => goWithin(state.frame - 1);
    id("next").onclick = () => goWithin(state.frame + 1);
    id("play").onclick = play;
    id("next-bad").onclick = () => toBad(1);
    id("fit").onclick = fit;
    id("divider").addEventListener("pointerdown", drag);
    L.DomEvent.disableClickPropagation(id("divider"));
  };

  const keys = {
    ArrowLeft: () => goWithin(state.frame - 1), ArrowRight: () => goWithin(state.frame + 1),
    Home: () => go(range()[0]), End: () => go(range()[1]),
    " ": play, n: () => toBad(1), p: () => toBad(-1), f: () => fit(), "+": () => map.zoomIn(0.5), "-": () => map.zoomOut(0.5),
    b: () => { state.share = state.share > 0.5 ? 0 : 1; clip(); },
  };

  dvi.frameView = {
    state,
    /** Sets the part of the next frame that is shown: x, y, width, height. */
    lookAt: (part) => { state.look = part; },
  };

  dvi.views.frames = {
    title: "Frames",
    start: () => {
      if (!window.L || !dvi.frames().length) {
        const text = dvi.frames().length ? "No pictures: this dvi was built without the package libjs-leaflet." : "This result has no frames yet.";
        id("frames").replaceChildren(e("p", {className: "lead", textContent: text}));
        return;
      }
      makeMap();
      makeControls();
      dvi.noReceipt(t.receipt);
    },
    show: (argument) => {
      if (!map) return;
      map.invalidateSize({animate: false});
      const wanted = argument === undefined ? state.frame : Number.parseInt(argument, 10) || 0;
      show(wanted);
    },
    hide: () => { if (map) stop(); },
    key: (event) => {
      if (!map) return false;
      const overlay = t.overlays.find((o) => o.key === event.key);
      if (overlay) setOverlay(overlay.name);
      else if (keys[event.key] && !(event.key === " " && event.target.matches("button"))) keys[event.key]();
      else return false;
      return true;
    },
  };
})();
