"use strict";
// How the result was made: poses, exposure, alignment, cost, options.
(() => {
  const e = dvi.element;

  const block = (title, hint, ...content) => e("article", {}, e("h2", {textContent: title}), e("p", {className: "hint", textContent: hint}), ...content);
  const table = (head, rows) => e("table", {className: "wide"}, e("thead", {}, e("tr", {}, head.map((text) => e("th", {textContent: text})))),
    e("tbody", {}, rows.map((row) => e("tr", {}, row.map((cell) => e("td", {}, cell))))));
  const millimeters = (meters) => (Number.isFinite(meters) ? `${(1000 * meters).toFixed(1)} mm` : "–");

  const poses = () => {
    const rows = (dvi.data.run.drives || []).map((drive) => {
      const {given, loam} = (drive.poses || {}).sharpness || {};
      const sharp = (s) => (s ? `${millimeters(s.ground_m)} / ${millimeters(s.vertical_m)}` : "–");
      const aligned = drive.alignment ? (drive.alignment.kept ? "refined" : "kept as given") : "–";
      return [drive.path.split("/").pop(), drive.camera, String(drive.frames), String(drive.scans), (drive.poses || {}).from || "–", sharp(given), sharp(loam), aligned];
    });
    return block("Poses and their sharpness", "Thickness of the ground and of walls in the map with these poses: smaller is sharper. The sharper poses are used.",
      table(["drive", "camera", "frames", "scans", "poses used", "given: ground / walls", "estimated: ground / walls", "camera alignment"], rows));
  };

  const cost = () => {
    const stages = ((dvi.data.run.cost || {}).stages || []).filter((stage) => stage.cpu_seconds > 0);
    const chart = e("div", {className: "chart tall", style: `height:${60 + 22 * stages.length}px`});
    const memory = (dvi.data.run.cost || {}).peak_memory_bytes;
    return {node: block("Time and memory", `CPU seconds of each stage. Peak memory ${memory ? Math.round(memory / 1e6) + " MB" : "unknown"}.`, chart),
      draw: () => dvi.chart(chart, {type: "bar", data: {labels: stages.map((s) => s.stage), datasets: [
        {label: "CPU seconds", data: stages.map((s) => s.cpu_seconds), backgroundColor: "#0072b2"},
        {label: "elapsed seconds", data: stages.map((s) => s.seconds), backgroundColor: "#e69f00"}]},
      options: {indexAxis: "y", scales: {x: dvi.axis("seconds")}, plugins: {legend: {labels: {boxWidth: 12}}}}})};
  };

  const lines = (title, hint, unit, series) => {
    const chart = e("div", {className: "chart"});
    return {node: block(title, hint, chart), draw: () => dvi.linesOverFrames(chart, series, unit)};
  };

  const exposure = () => lines("Exposure over time", "Gains that adapt each frame to a common exposure; 1 is as recorded. Steps and swings are those of the camera.", "gain",
    [["red", "#d55e00"], ["green", "#009e73"], ["blue", "#0072b2"]].map(([label, color], i) =>
      ({label, color, values: dvi.frames().map((frame) => (frame.exposure_gain || [])[i])})));

  const alignment = () => lines("Alignment", "Median position error of map points in a frame, before and after the alignment of the camera.", "px",
    [["before", "#999999", "offset_before_px"], ["after", "#0072b2", "offset_after_px"]].map(([label, color, key]) =>
      ({label, color, values: dvi.frames().map((frame) => (frame.alignment || {})[key])})));

  const truth = () => {
    const frames = (dvi.data.evaluation || {}).per_frame;
    if (!frames) return null;
    const by = new Map(frames.map((frame) => [frame.name, frame]));
    return lines("Error against the truth", "Mean absolute difference inside the removed area.", "gray levels",
      [{label: "MAE", color: "#d55e00", values: dvi.frames().map((frame, i) => ((by.get(dvi.frameName(i)) || {}).all || {}).mae)}]);
  };

  const options = () => block("Options that differ from the default", "dvi.toml beside this page has all options.",
    dvi.data.options.length ? table(["option", "value", "default", "meaning"], dvi.data.options.map((o) => [o.name, o.value, o.default, o.doc]))
      : e("p", {textContent: "None: all options have their defaults."}));

  dvi.views.stages = {
    title: "Stages",
    start: () => {
      const drawn = [truth(), cost(), exposure(), alignment()].filter(Boolean);
      dvi.byId("stages").append(poses(), ...drawn.map((part) => part.node), options());
      drawn.forEach((part) => part.draw());
    },
  };
})();
