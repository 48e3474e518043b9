"use strict";
// The table of removed objects.
(() => {
  const e = dvi.element, t = dvi.texts.objects;
  const shown = 15, most = 500, doubtful = 20;

  const visibleFrames = (object) => (object.residue && object.residue.remains_visible ? object.residue.visible_frames : []);

  /** Frame numbers as ranges, each a link to its first frame. */
  const frameLinks = (numbers, camera) => {
    const ranges = [];
    for (const number of numbers) {
      const last = ranges[ranges.length - 1];
      if (last && last[1] === number - 1) last[1] = number;
      else ranges.push([number, number]);
    }
    return ranges.flatMap(([first, last], i) => {
      const text = first === last ? `${first}` : `${first}–${last}`;
      const frame = dvi.frames().findIndex((entry) => entry.number === first && entry.camera === camera);
      return [i ? ", " : "", frame < 0 ? text : e("a", {href: `#frames/${frame}`, textContent: text})];
    });
  };

  const residueCell = (object) => {
    if (!object.residue) return "not measured";
    const frames = visibleFrames(object);
    return frames.length ? e("span", {className: "bad"}, frameLinks(frames, object.camera)) : "no";
  };

  const row = (object) => [object.camera ? `${object.object}, ${object.camera}` : String(object.object), object.class || "–",
    object.evidence || "–", object.motion, frameLinks([object.first_frame], object.camera), frameLinks([object.last_frame], object.camera),
    frameLinks(object.completed_frames, object.camera), object.removed_pixels.toLocaleString("en"), residueCell(object)];

  const table = (objects) => e("table", {className: "wide"},
    e("thead", {}, e("tr", {}, t.columns.map(([name, hint]) => e("th", {textContent: name, title: hint})))),
    e("tbody", {}, objects.map((object) => e("tr", {}, row(object).map((cell) => e("td", {}, cell))))));

  /** The objects of which the result may still show most: their worst frames, before and after. */
  dvi.doubtfulObjects = () => {
    const score = (object) => object.residue.highest_score;
    const objects = (dvi.data.objects || []).filter((object) => object.residue && object.residue.highest_score_box)
      .sort((a, b) => visibleFrames(b).length - visibleFrames(a).length || score(b) - score(a) || b.removed_pixels - a.removed_pixels).slice(0, doubtful);
    if (!objects.length) return null;
    const card = (object) => {
      const frame = dvi.frames().findIndex((entry) => entry.number === object.residue.highest_score_frame && entry.camera === object.camera);
      const entry = dvi.data.frames[frame];
      if (!entry || !entry.size) return null;
      const [x, y, width, height] = object.residue.highest_score_box, around = 0.25 * Math.max(width, height, 16);
      const part = [x - around, y - around, width + 2 * around, height + 2 * around];
      const picture = (title, pictures) => e("figure", {}, dvi.crop(pictures, entry.size, part), e("figcaption", {textContent: title}));
      return e("a", {className: "card", href: `#frames/${frame}`},
        e("div", {className: "pair"}, picture("before", dvi.before(frame)), picture("after", [entry.picture])),
        e("p", {}, t.doubtful(object, dvi.frameName(frame), visibleFrames(object).length > 0)));
    };
    return e("article", {id: "doubtful"}, e("h2", {textContent: "Check before publishing"}),
      e("p", {className: "hint", textContent: t.publishing}), e("div", {className: "cards sheet"}, objects.map(card)));
  };

  /** Objects that remain visible first, then by size; beyond the first ones in a closed part; null if the list is missing. */
  dvi.objectTable = () => {
    if (!dvi.data.objects) return null;
    const objects = [...dvi.data.objects].sort((a, b) =>
      visibleFrames(b).length - visibleFrames(a).length || b.removed_pixels - a.removed_pixels || a.object - b.object);
    const count = (some) => new Set(some.map((object) => object.object)).size;
    const visible = count(objects.filter((object) => visibleFrames(object).length));
    const listed = objects.slice(0, most);
    const more = listed.slice(shown);
    return e("article", {id: "objects"}, e("h2", {textContent: "Removed objects"}),
      e("p", {className: "hint", textContent: objects.length ? t.summary(count(objects), visible) : t.none}),
      objects.length ? table(listed.slice(0, shown)) : null,
      more.length ? e("details", {}, e("summary", {textContent: `${more.length} more`}), table(more)) : null,
      objects.length > most ? e("p", {className: "hint", textContent: `${objects.length - most} more in objects.json.`}) : null);
  };
})();
