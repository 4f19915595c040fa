/** Reference of edge-fade.wgsl: 0 up to an edge, 1 from `width` beyond it, smooth in between. */
export function edgeFade(clearance: number, width: number): number {
  if (clearance <= 0) return 0;
  if (clearance >= width) return 1;
  const t = clearance / width;
  return t * t * (3 - 2 * t);
}
