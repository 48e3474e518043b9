"use strict";
// The table of removed objects.
(() => {
  const e = dvi.element, t = dvi.texts.objects;
  const shown = 15, most = 500;

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
