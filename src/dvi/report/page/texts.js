"use strict";
// All words about figures, in one place: what a number means and what to do about it.
dvi.texts = {
  // As kind/NAME.png numbers them. Colors by Okabe and Ito, which color-blind people can tell apart.
  kinds: [
    {name: "original", color: null, hint: "Not touched: exactly as recorded."},
    {name: "copied", key: "copied", color: "#0072b2", hint: "Copied from another frame of this drive that saw the place free of traffic."},
    {name: "from elsewhere", key: "copied_elsewhere", color: "#56b4e9", hint: "Copied from another camera or another drive of the same place."},
    {name: "interpolated", key: "interpolated", color: "#e69f00", hint: "No frame saw this place. It was filled smoothly from its surroundings: plausible, but not evidence."},
    {name: "synthesized", key: "synthesized", color: "#cc79a7", hint: "No frame saw this place. Texture of the same surface was continued: plausible, but not evidence."},
    {name: "left empty", key: "empty", color: "#999999", hint: "No frame saw this place, and nothing was put there."},
  ],
  within: {label: "expected to be right", hint: "Mean confidence of the filled pixels: the share that should be within 10 gray levels (of 255) of what really was there."},
  truth: {
    psnr: {label: "PSNR", unit: "dB", digits: 2, hint: "Peak signal-to-noise ratio against the truth, inside the removed area. 30 dB and more is hard to see; below 20 dB is another picture."},
    mae: {label: "mean error", unit: "levels", digits: 2, hint: "Mean absolute difference to the truth, in gray levels of 255."},
    ssim: {label: "SSIM", unit: "", digits: 3, hint: "Structural similarity with the truth; 1 is the same."},
    sharpness: {label: "sharpness", unit: "", digits: 2, hint: "1: as sharp as the truth; below: blurred."},
    flicker: {label: "flicker", unit: "", digits: 2, hint: "1: as steady over time as the truth; above: it flickers."},
  },
  overlays: [
    {name: "none", key: "0", title: "none"},
    {name: "mask", key: "m", title: "removed area"},
    {name: "kind", key: "k", title: "where pixels come from"},
    {name: "confidence", key: "c", title: "confidence", low: "0 %: surely wrong", high: "100 %: surely within 10 gray levels"},
    {name: "depth", key: "d", title: "depth", low: "near", high: "far"},
    {name: "blending", key: "e", title: "what blending changed", low: "nothing", high: "40 gray levels or more"},
    {name: "error", key: "x", title: "difference to the truth", low: "none", high: "64 gray levels or more", truth: true},
  ],
  keys: "Keys: arrows frame by frame, space play, n and p the next and previous bad place, m k c d e overlays, 0 none, " +
    "b all before or all after, f the whole frame, + and - zoom. Click a pixel for where it comes from; the wheel zooms, dragging moves.",
  receipt: "Click a pixel of the picture to see where it comes from.",
  // What to do about a warning, by words in it; the first that fits.
  advice: [
    [/camera|calibrat|mounting/i, "Compare the calibration with the recording: dvi check DRIVE shows what contradicts it."],
    [/pose|odometry|trajectory/i, "Try --poses loam or --poses given and compare the sharpness on the page Stages."],
    [/mask|label|detector/i, "Look at the overlay “removed area” in the frames: is all traffic inside, and nothing else? docs/masks.md"],
    [/clock|time|stamp/i, "Check the clock offsets of camera and scanner: dvi check DRIVE."],
    [/memory/i, "Raise job.memory_mb (--set job.memory_mb=N), or fill a part: --frames A:B."],
  ],
  defaultAdvice: "Look at the frames around it, and run dvi check DRIVE.",
  problemAdvice: "The page shows what is there. Run the same dvi run again to complete the result, or dvi report to write this page anew.",
};

dvi.texts.adviceFor = (warning) => {
  const found = dvi.texts.advice.find(([words]) => words.test(warning));
  return found ? found[1] : dvi.texts.defaultAdvice;
};
