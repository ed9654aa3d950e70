// The values of a chain's motion: read from a message, interpolated at an instant, and the largest of them.

// The four series of a chain, taken from the single array of a message from index `start` on, and the index after them.
export function unpack({ rows, beads, values }, start = 0) {
  const series = {};
  let end = start;
  for (const [name, width] of [
    ["displacement", beads],
    ["force", beads + 1],
    ["energy", beads],
    ["drive", 1],
  ]) {
    // A plain Float32Array, because `subarray` of Bokeh's own array class ignores the offset.
    series[name] = new Float32Array(values.buffer, values.byteOffset + 4 * end, rows * width);
    end += rows * width;
  }
  return { series, end };
}

// The largest displacement, overlap and force of a picture.
export function extremes({ rows, beads, displacement: u, drive, force: forces }) {
  let overlap = 0,
    largest = 0,
    force = 0;
  for (let row = 0; row < rows; row++)
    for (let c = 0; c <= beads; c++) {
      const l = c === 0 ? drive[row] : u[row * beads + c - 1];
      const r = c === beads ? 0 : u[row * beads + c];
      overlap = Math.max(overlap, l - r);
      largest = Math.max(largest, Math.abs(l));
      force = Math.max(force, Math.abs(forces[row * (beads + 1) + c]));
    }
  return { overlap, largest, force };
}

// Linear interpolation between rows.
export function sampler(frames, row) {
  const { beads, rows } = frames;
  const a = Math.max(0, Math.min(rows - 1, Math.floor(row)));
  const b = Math.min(a + 1, rows - 1);
  const s = Math.min(1, Math.max(0, row - a));
  const mix = (array, stride, i) => array[a * stride + i] * (1 - s) + array[b * stride + i] * s;
  return {
    u: (i) => (i === 0 ? mix(frames.drive, 1, 0) : i > beads ? 0 : mix(frames.displacement, beads, i - 1)),
    force: (c) => (s < 0.5 ? frames.force[a * (beads + 1) + c] : frames.force[b * (beads + 1) + c]),
    energy: (i) => mix(frames.energy, beads, i - 1),
  };
}
