"use strict";
// The drive from above: x of the world to the right, y up, in meters.
(() => {
  const e = dvi.element, id = dvi.byId;
  const colors = {path: "#0072b2", removed: "#e63c3c", unseen: "#e69f00"};

  const nearest = (poses, at) => {
    let best = 0, least = Infinity;
    poses.forEach((pose, i) => {
      const distance = (pose[3] - at.lng) ** 2 + (pose[7] - at.lat) ** 2;
      if (distance < least) [best, least] = [i, distance];
    });
    return best;
  };

  const draw = (above) => {
    const map = L.map("map", {crs: L.CRS.Simple, zoomSnap: 0, minZoom: -4, maxZoom: 8, attributionControl: false, keyboard: false, zoomAnimation: false, preferCanvas: true});
    dvi.mapView = {map};
    const poses = above.world_from_camera, path = poses.map((pose) => [pose[7], pose[3]]);
    const near = ([y, x]) => path.some(([py, px]) => (py - y) ** 2 + (px - x) ** 2 < 40 ** 2);
    const tracked = above.tracks.flatMap((track) => track.points.map(([x, y]) => [y, x])).filter(near);
    const [south, west, north, east] = [...path, ...tracked].reduce(([a, b, c, d], [y, x]) =>
      [Math.min(a, y), Math.min(b, x), Math.max(c, y), Math.max(d, x)], [Infinity, Infinity, -Infinity, -Infinity]);
    const margin = 15;  // meters: the road and the structures beside it
    map.fitBounds([[south - margin, west - margin], [north + margin, east + margin]], {animate: false});
    const right = above.left_m + above.width * above.meters_per_px, bottom = above.top_m - above.height * above.meters_per_px;
    const ground = L.imageOverlay("map/map.png", [[bottom, above.left_m], [above.top_m, right]], {className: "pixels"}).addTo(map);
    ground.on("error", () => id("map-legend").append(e("span", {className: "warning", textContent: "map/map.png is missing"})));

    const {cell_m: cell, cells} = dvi.data.unseen;
    const shown = ([x, y]) => x * cell >= above.left_m && x * cell < right && y * cell >= bottom && y * cell < above.top_m;
    const unseen = L.layerGroup(cells.filter(shown).map(([x, y, frame, pixels]) =>
      L.rectangle([[y * cell, x * cell], [(y + 1) * cell, (x + 1) * cell]], {stroke: false, fillColor: colors.unseen, fillOpacity: 0.5})
        .bindTooltip(`no source observed this; most pixels are in frame ${dvi.frameName(frame)} (about ${pixels * 16} px)`)
        .on("click", (event) => { L.DomEvent.stopPropagation(event); dvi.go("frames", frame); }))).addTo(map);

    const tracks = L.layerGroup(above.tracks.filter((track) => track.points.length).map((track) =>
      L.polyline(track.points.map(([x, y]) => [y, x]), {color: "#cc79a7", weight: 3, dashArray: track.points.length > 1 ? "6 4" : null})
        .bindTooltip(`${track.type || "object"} ${track.number}, frames ${dvi.frameName(track.points[0][2])} on`)
        .on("click", (event) => { L.DomEvent.stopPropagation(event); dvi.go("frames", track.points[0][2]); }))).addTo(map);

    L.polyline(path, {color: "#ffffff", weight: 7, opacity: 0.8}).addTo(map);
    L.polyline(path, {color: colors.path, weight: 4}).addTo(map);
    const every = Math.max(1, Math.floor(poses.length / 400));
    path.forEach((at, i) => i % every === 0 && L.circleMarker(at, {radius: 4, color: "#ffffff", weight: 1, fillColor: colors.path, fillOpacity: 1})
      .bindTooltip(`frame ${dvi.frameName(i)}`).on("click", (event) => { L.DomEvent.stopPropagation(event); dvi.go("frames", i); }).addTo(map));
    map.on("click", (event) => dvi.go("frames", nearest(poses, event.latlng)));
    L.control.layers(null, {"unobserved": unseen, "tracks of removed objects": tracks}, {collapsed: false}).addTo(map);
    L.control.scale({imperial: false}).addTo(map);
  };

  dvi.views.above = {
    title: "From above",
    start: () => {
      const above = dvi.data.above;
      if (!above || !window.L || !above.world_from_camera.length) {
        id("above-text").textContent = !above ? "This result has no map: methods without depth do not make one, and results of earlier versions have no picture of it."
          : window.L ? "No frame of this result has a pose." : "No map: this dvi was built without the package libjs-leaflet.";
        id("map").remove();
        return;
      }
      id("above-text").textContent = "The static map that gives pixels their depth. Click the path, or any position, to go to the nearest frame.";
      const entry = (color, text, hint) => e("span", {className: "entry", title: hint}, e("i", {className: "swatch", style: `background:${color}`}), text);
      id("map-legend").append(
        entry(colors.path, "path of the camera", "One dot per frame."),
        entry(colors.removed, "returns removed from the map", "On traffic according to masks or boxes, or absent in other scans."),
        entry("#cc79a7", "tracks of removed objects", "Positions of labeled objects in each frame."),
        entry(colors.unseen, "not observed by any frame", "Filled pixels that no other frame observed show these half-meter squares."));
      draw(above);
    },
    show: () => { if (dvi.mapView) dvi.mapView.map.invalidateSize({animate: false}); },
  };
})();
