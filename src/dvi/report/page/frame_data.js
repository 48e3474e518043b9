"use strict";
// The provenance of a frame's hole: data_NNNNNN.js, loaded on demand (its format: frame_block.h). A few are kept in memory.
(() => {
  const kept = new Map();     // by frame: promise of its block, the most recently used last
  const arrived = new Map();  // by frame: the data from its script
  const maxKept = 6;

  dvi.block = (frame, width, height, fields, base64) => arrived.set(frame, {width, height, fields, base64});

  const bytesOf = async (base64) => {
    const text = atob(base64);
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  };

  class Block {
    constructor({width, height, fields}, bytes) {
      Object.assign(this, {width, height});
      this.kind = bytes.subarray(0, width * height);
      this.hole = [];  // pixels of the hole, in raster order, which the fields describe
      for (let i = 0; i < this.kind.length; ++i) if (this.kind[i]) this.hole.push(i);
      let at = width * height;
      this.fields = {};
      for (const [name, size] of fields) {
        this.fields[name] = this.decoded(bytes.subarray(at, at + size * this.hole.length), size);
        at += size * this.hole.length;
      }
    }
    decoded(bytes, size) {
      if (size === 1) return bytes;
      const count = this.hole.length, out = new Uint16Array(count);
      for (let i = 0, value = 0; i < count; ++i) out[i] = value = (value + bytes[i] + 256 * bytes[count + i]) & 65535;
      return out;
    }
    /** Returns the values of a pixel, or null outside the hole. */
    at(x, y) {
      const pixel = y * this.width + x;
      if (x < 0 || y < 0 || x >= this.width || y >= this.height || !this.kind[pixel]) return null;
      let low = 0, high = this.hole.length - 1;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.hole[middle] < pixel) low = middle + 1;
        else high = middle;
      }
      const values = {kind: this.kind[pixel]};
      for (const [name, field] of Object.entries(this.fields)) values[name] = field[low];
      return values;
    }
  }

  const load = (frame) => new Promise((resolve, reject) => {
    const script = dvi.element("script", {src: dvi.numbered("data_", frame, ".js")});
    const name = script.getAttribute("src");
    script.onload = () => {
      const packed = arrived.get(frame);
      arrived.delete(frame);
      script.remove();
      if (packed) resolve(bytesOf(packed.base64).then((bytes) => new Block(packed, bytes)));
      else reject(new Error(`${name} is damaged`));
    };
    script.onerror = () => {
      script.remove();
      reject(new Error(`${name} is missing`));
    };
    document.head.append(script);
  });

  /** Returns a promise of a frame's provenance; it is rejected with the reason if there is none. */
  dvi.receipts = (frame) => {
    const promise = kept.get(frame) || (dvi.data.frames[frame].size ? load(frame) : Promise.reject(new Error("pictures of this frame are missing")));
    kept.delete(frame);
    kept.set(frame, promise);
    if (kept.size > maxKept) kept.delete(kept.keys().next().value);
    return promise;
  };
})();
