"use strict";
// The provenance of a pixel: values, and both positions side by side.
(() => {
  const e = dvi.element, t = dvi.texts;
  const shown = [40, 30];  // size of a crop in px
  const noChange = 32768;  // as in harmonization/

  const around = ([x, y], size) => [
    Math.max(0, Math.min(size[0] - shown[0], x + 0.5 - shown[0] / 2)),
    Math.max(0, Math.min(size[1] - shown[1], y + 0.5 - shown[1] / 2)), ...shown];

  const row = (name, value, hint) => e("tr", {title: hint || ""}, e("th", {textContent: name}), e("td", {}, value));

  const apart = (frame, source) => {
    const [first, last] = dvi.cameraRange(frame);
    if (source.frame < first || source.frame > last) return null;  // another camera or drive
    const times = dvi.data.times, frames = source.frame - frame;
    const direction = frames < 0 ? "earlier" : "later";
    const seconds = times && times.length > Math.max(source.frame, frame) ? `, ${Math.abs(times[source.frame] - times[frame]).toFixed(1)} s` : "";
    return `${Math.abs(frames)} frame${Math.abs(frames) === 1 ? "" : "s"}${seconds} ${direction}`;
  };

  const figure = (title, svg) => {
    const caption = e("figcaption", {textContent: title});
    svg.addEventListener("gone", () => { caption.textContent = `${title}: the picture is missing`; });
    return e("figure", {}, svg, caption);
  };

  const sourceRows = (frame, values, source) => {
    const change = ["red", "green", "blue"].map((name) => (values[name] === undefined ? NaN : values[name] - noChange));
    return [
      row("source", source ? `frame ${source.name}` : `number ${values.source - 1}`, "The image that shows the background without traffic."),
      source ? row("camera", source.camera) : null,
      row("position", e("span", {id: "source-position", textContent: `${values.x / 16}, ${values.y / 16}`}), "Column and row in the source image, to a sixteenth of a pixel."),
      source && apart(frame, source) ? row("in time", apart(frame, source), "Distance in time between the source and this frame.") : null,
      row("blending", change.every(Number.isFinite) ? change.map((c) => (c > 0 ? "+" : "") + c).join(" ") + " levels" : "–",
        "Change of red, green, and blue of the copy by blending with the surroundings."),
      values.averaged > 1 ? row("averaged", `${values.averaged} sources`, "The colors of several frames that agree were averaged.") : null,
    ];
  };

  /** Shows the provenance of a pixel of a frame; values are null outside the removed area. */
  dvi.showReceipt = (frame, x, y, values) => {
    const entry = dvi.data.frames[frame], size = entry.size;
    const kind = t.kinds[values ? values.kind : 0];
    const copied = values && values.source > 0;
    const source = copied ? dvi.source(values.source - 1) : null;
    const position = copied ? [values.x / 16, values.y / 16] : null;
    const crops = [figure("this pixel", dvi.crop([entry.picture], size, around([x, y], size), [x, y]))];
    if (copied) {
      const own = source && source.frame >= 0;
      const pictures = own ? dvi.before(source.frame) : [dvi.numbered("sources/", values.source - 1, ".jpg")];
      const of = own ? dvi.data.frames[source.frame].size : size;
      crops.push(figure(`the source${source ? ", frame " + source.name : ""}`, dvi.crop(pictures, of, around(position, of), position)));
    }
    if (values) crops.push(figure("before", dvi.crop(dvi.before(frame), size, around([x, y], size), [x, y])));
    const rows = [
      row("pixel", e("span", {id: "pixel-position", textContent: `${x}, ${y}`}), "Column and row in this frame, from 0."),
      row("kind", e("span", {}, kind.color ? e("i", {className: "swatch", style: `background:${kind.color}`}) : null, kind.name), kind.hint),
      values && values.confidence !== undefined ? row("confidence", dvi.percent(values.confidence / 255, 0), t.within.hint) : null,
      values && values.depth ? row("depth", `${(values.depth / 256).toFixed(2)} m`, "Distance along the optical axis.") : null,
      ...(copied ? sourceRows(frame, values, source) : []),
      kind.key === "imported" && (dvi.frames()[frame] || {}).external ? row("file", dvi.frames()[frame].external.file, "The image of the other program.") : null,
      values && values.error !== undefined ? row("error", `${values.error} levels`, "Largest difference of red, green, or blue from the truth.") : null,
    ];
    dvi.byId("receipt").replaceChildren(...[
      e("h2", {textContent: "Where this pixel comes from"}),
      e("p", {className: "hint", textContent: kind.hint}),
      e("table", {}, rows),
      e("div", {className: "receipt-crops"}, crops),
      source && source.frame >= 0 ? e("button", {id: "to-source", textContent: "Go to the source frame", onclick: () => {
        dvi.frameView.lookAt(around(position, size));
        dvi.go("frames", source.frame);
      }}) : null,
    ].filter(Boolean));
  };

  dvi.noReceipt = (text) => dvi.byId("receipt").replaceChildren(e("h2", {textContent: "Provenance"}), e("p", {className: "hint", textContent: text}));
})();
