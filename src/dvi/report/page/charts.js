"use strict";
// Charts in the colors of the page.
(() => {
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  /** Draws a chart in a new canvas in `parent`, or a note if the library is missing. */
  dvi.chart = (parent, config) => {
    if (!window.Chart) {
      parent.replaceChildren(dvi.element("p", {className: "hint", textContent: "No charts: this dvi was built without the package libjs-chart.js."}));
      return null;
    }
    const canvas = parent.querySelector("canvas") || parent.appendChild(dvi.element("canvas"));
    Chart.defaults.color = color("--soft");
    Chart.defaults.borderColor = color("--line");
    Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
    const options = Object.assign({animation: false, responsive: true, maintainAspectRatio: false}, config.options);
    return new Chart(canvas, Object.assign({}, config, {options}));
  };

  const axis = (text, more = {}) => Object.assign({title: {display: true, text}}, more);
  dvi.axis = axis;

  /** Draws values per frame as lines; a click goes to the frame. `series`: {label, color, values, hint}. */
  dvi.linesOverFrames = (parent, series, title) =>
    dvi.chart(parent, {
      type: "line",
      data: {
        labels: dvi.frames().map((frame, i) => dvi.frameName(i)),
        datasets: series.map(({label, color: of, values}) =>
          ({label, data: values, borderColor: of, backgroundColor: of, borderWidth: 1.5, pointRadius: values.length < 60 ? 2 : 0})),
      },
      options: {
        interaction: {mode: "index", intersect: false},
        onClick: (event, elements) => elements.length && dvi.go("frames", elements[0].index),
        scales: {x: axis("frame", {ticks: {maxRotation: 0, autoSkipPadding: 24}}), y: axis(title)},
        plugins: {legend: {labels: {boxWidth: 12}}},
      },
    });

  /** Draws the shares of the hole by kind, stacked, of each frame of the camera of the frame `current()`, which is marked. */
  dvi.shareStrip = (parent, current) => {
    const [first, last] = dvi.cameraRange(current());
    const frames = dvi.frames().slice(first, last + 1);
    const kinds = dvi.texts.kinds.filter((kind) => kind.key && dvi.frames().some((frame) => frame.hole && frame.hole[kind.key] > 0));
    const mark = {
      id: "current",
      afterDraw: (chart) => {
        const {left, right, top, bottom} = chart.chartArea;
        const x = left + ((right - left) * (current() - first + 0.5)) / Math.max(1, chart.data.labels.length);
        chart.ctx.save();
        chart.ctx.strokeStyle = color("--ink");
        chart.ctx.lineWidth = 2;
        chart.ctx.strokeRect(x - 2, top - 2, 4, bottom - top + 4);
        chart.ctx.restore();
      },
    };
    return dvi.chart(parent, {
      type: "bar",
      data: {
        labels: frames.map((frame) => frame.name),
        datasets: kinds.map((kind) => ({
          label: kind.name, backgroundColor: kind.color, barPercentage: 1, categoryPercentage: frames.length > 150 ? 1 : 0.9,
          data: frames.map((frame, i) => {
            const size = dvi.data.frames[first + i].size;
            return frame.hole && size ? (100 * frame.hole[kind.key]) / (size[0] * size[1]) : 0;
          }),
        })),
      },
      options: {
        onClick: (event, elements, chart) => {
          const {left, right} = chart.chartArea;
          const frame = Math.floor(((event.x - left) / (right - left)) * chart.data.labels.length);
          dvi.go("frames", first + Math.max(0, Math.min(chart.data.labels.length - 1, frame)));
        },
        interaction: {mode: "index", intersect: false},
        scales: {
          x: {stacked: true, grid: {display: false}, ticks: {maxRotation: 0, autoSkipPadding: 24}},
          y: axis("% of image", {stacked: true, ticks: {maxTicksLimit: 4}}),
        },
        plugins: {
          legend: {position: "right", labels: {boxWidth: 12}},
          tooltip: {callbacks: {label: (item) => `${item.dataset.label}: ${item.parsed.y.toFixed(2)} % of the image`}},
        },
      },
      plugins: [mark],
    });
  };
})();
