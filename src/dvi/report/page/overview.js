"use strict";
// The first screen: the removed area and the quality of the filling.
(() => {
  const e = dvi.element, t = dvi.texts;

  const mean = (values) => (values.length ? values.reduce((a, b) => a + b, 0) / values.length : NaN);

  // The mean over the pixels of all holes, not over frames.
  const within = () => {
    let pixels = 0, doubtful = 0;
    dvi.data.frames.forEach((entry, i) => {
      const hole = dvi.frames()[i].hole;
      if (entry.size && hole) {
        pixels += hole.pixels;
        doubtful += entry.doubtful;
      }
    });
    return pixels ? 1 - doubtful / pixels : NaN;
  };

  const sentence = () => {
    const frames = dvi.frames();
    if (!frames.length) return "This result has no frames yet.";
    const shares = frames.map((frame, i) => {
      const size = dvi.data.frames[i].size;
      return size && frame.hole ? frame.hole.pixels / (size[0] * size[1]) : NaN;
    }).filter(Number.isFinite);
    const hole = (dvi.data.run.hole || {}).share;
    if (!hole || !dvi.data.run.hole.pixels) return `${frames.length} frames. Nothing was removed from them.`;
    const seen = hole.copied + hole.copied_elsewhere;
    return `Traffic was removed from ${frames.length} frames; on average it covered ${dvi.percent(mean(shares))} of the image. ` +
      `${dvi.percent(seen, 0)} of that shows the real background, observed by other frames` +
      (seen < 0.995 ? `; ${dvi.percent(1 - seen, 0)} was not observed by any frame.` : ".");
  };

  const tile = (value, label, hint, color) =>
    e("div", {className: "tile", title: hint},
      e("div", {className: "value", textContent: value}),
      e("div", {className: "label"}, color ? e("i", {className: "swatch", style: `background:${color}`}) : null, label),
      e("div", {className: "hint", textContent: hint}));

  const tiles = () => {
    const share = (dvi.data.run.hole || {}).share || {};
    const kinds = t.kinds.filter((kind) => kind.key && (!["empty", "imported"].includes(kind.key) || share[kind.key] > 0));
    return e("div", {className: "tiles"},
      kinds.map((kind) => tile(dvi.percent(share[kind.key]), kind.name, kind.hint, kind.color)),
      tile(dvi.percent(within()), t.within.label, t.within.hint));
  };

  const truthTiles = () => {
    const figures = (dvi.data.evaluation || {}).all;
    if (!figures) return null;
    return e("div", {}, e("h2", {textContent: "Against the truth"}),
      e("div", {className: "tiles"}, Object.entries(t.truth).map(([key, text]) =>
        tile(`${dvi.number(figures[key], text.digits)} ${text.unit}`, text.label, text.hint))));
  };

  const hints = () => {
    const hole = (dvi.data.run.hole || {}).share || {};
    const list = [];
    if (hole.unobserved > 0.4)
      list.push(["A large part of the removed area was not observed by any frame.",
        "A second drive through the same street as a SOURCE, or more cameras of this drive (--sources all), would observe more of it."]);
    const stationary = dvi.data.run.stationary;
    if (stationary && stationary.pixels > 0.5 * dvi.data.run.hole.pixels)
      list.push([`${stationary.stationary} of ${stationary.tracks} removed objects are stationary all the time.`,
        "The background behind them cannot be observed. --remove moving keeps them in the frames."]);
    return list;
  };

  const notices = () => {
    const run = dvi.data.run;
    const warnings = [...(run.warnings || []), ...(run.drives || []).flatMap((drive) =>
      [...(drive.warnings || []), ...(drive.other_cameras || []).flatMap((camera) => camera.warnings || [])])];
    const items = [
      ...dvi.data.problems.map((text) => ["problem", text, t.problemAdvice]),
      ...[...new Set(warnings)].map((text) => ["warning", text, t.adviceFor(text)]),
      ...hints().map(([text, advice]) => ["note", text, advice]),
    ];
    if (!items.length) return e("p", {className: "good", textContent: "No warnings."});
    return e("ul", {className: "notices"}, items.map(([kind, text, advice]) =>
      e("li", {className: kind}, e("strong", {textContent: text}), e("span", {textContent: advice}))));
  };

  /** The frames with most pixels that are expected to be wrong in their worst part; only the worst of neighboring frames. */
  dvi.worstFrames = (count) => {
    const apart = Math.max(1, Math.floor(dvi.data.frames.length / (count + 1)));
    const order = dvi.data.frames.map((entry, i) => i).filter((i) => dvi.data.frames[i].in_worst > 0)
      .sort((a, b) => dvi.data.frames[b].in_worst - dvi.data.frames[a].in_worst || a - b);
    const chosen = [];
    for (const i of order) {
      if (chosen.length === count) break;
      if (chosen.every((other) => Math.abs(other - i) >= apart)) chosen.push(i);
    }
    return chosen;
  };

  const card = (frame) => {
    const entry = dvi.data.frames[frame];
    const picture = (title, pictures) => e("figure", {}, dvi.crop(pictures, entry.size, entry.worst), e("figcaption", {textContent: title}));
    const node = e("a", {className: "card", href: `#frames/${frame}`},
      e("div", {className: "pair"}, picture("before", dvi.before(frame)), picture("after", [entry.picture])),
      e("p", {}, `Frame ${dvi.frameName(frame)}: ${dvi.percent(entry.within, 0)} of its removed area is expected to be right. `,
        e("em", {textContent: "Look closer"})));
    node.addEventListener("click", () => dvi.frameView.lookAt(entry.worst));
    return node;
  };

  dvi.views.overview = {
    title: "Overview",
    start: () => {
      const worst = dvi.worstFrames(4);
      dvi.byId("overview").append(...[
        e("p", {className: "lead", textContent: sentence()}),
        dvi.frames().length ? tiles() : null,
        truthTiles(),
        e("h2", {textContent: "What to know"}),
        notices(),
        worst.length ? e("h2", {textContent: "The least certain parts"}) : null,
        e("div", {className: "cards"}, worst.map(card)),
        dvi.objectTable(),
        dvi.doubtfulObjects(),
        e("p", {className: "foot", textContent: `Made by dvi ${dvi.data.run.version || "(unknown version)"}, method ${dvi.data.run.method || "unknown"}.`}),
      ].filter(Boolean));
    },
  };
})();
