/** Twin of shaders/lib/dispatch.wgsl: dispatch size in x, y and z for `count` workgroups in rows of `row`. */
export function dispatchSize(count: number, row: number): [number, number, number] {
  return count <= row ? [count, 1, 1] : [row, Math.ceil(count / row), 1];
}
