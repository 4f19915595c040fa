import { type Crop, type Histograms, isKept } from '../state/inspecting.ts';
import type { DragRegion } from '../state/selecting.ts';
import { subtract, type Vec3 } from '../state/vec3.ts';
import { baseColorOf } from './base-color.ts';
import { floaterTest } from './floaters.ts';
import { binOf } from './histogram.ts';
import type { Region, SceneLook } from './inspect-messages.ts';
import { eachCenter, imagePlace, type ReadCloud, VALUES } from './scene-answers.ts';

type IsWithin = (cloud: ReadCloud, index: number, center: Vec3) => boolean;

/**
 * For each cloud one bit per row, bit `row % 32` of word `row / 32`. It is set if the crop keeps
 * the row's splat and the region contains it, by centre or by value.
 *
 * @param onPart called with the fraction done, 0…1, where that takes long.
 */
export function rowsWithin(
  clouds: readonly ReadCloud[],
  region: Region,
  crop: Crop | null,
  histogramsOf: () => Histograms,
  onPart?: (part: number) => void,
): Uint32Array<ArrayBuffer>[] {
  const isWithin =
    region.kind === 'floaters'
      ? floaterTest(clouds, region.filter, region.limit, onPart)
      : testOf(region, histogramsOf);
  return clouds.map((cloud) => {
    const { fileIndices } = cloud.set;
    const last = fileIndices.reduce((most, row) => Math.max(most, row), -1);
    const words = new Uint32Array(Math.ceil((last + 1) / 32));
    eachCenter([cloud], (center, i) => {
      if ((crop && !isKept(crop, center)) || !isWithin(cloud, i, center)) return;
      words[fileIndices[i] >>> 5] |= 1 << (fileIndices[i] & 31);
    });
    return words;
  });
}

function testOf(region: Exclude<Region, { kind: 'floaters' }>, histogramsOf: () => Histograms): IsWithin {
  switch (region.kind) {
    case 'all':
      return () => true;
    case 'bin': {
      const { quantity, bin } = region.marked;
      const histogram = histogramsOf()[quantity];
      return ({ set }, i) => binOf(VALUES[quantity](set, i), histogram) === bin;
    }
    case 'dragged': {
      const { look, width, height } = region;
      const isIn = dragTest(region.dragged, width, height);
      return (_cloud, _i, center) => isInImage(look, center, (x, y) => isIn(x * width, y * height));
    }
    case 'sphere': {
      const { center, radius } = region;
      return (_cloud, _i, place) => {
        const [x, y, z] = subtract(place, center);
        return x * x + y * y + z * z <= radius * radius;
      };
    }
    case 'color': {
      const { color, tolerance } = region;
      return ({ set }, i) =>
        baseColorOf(set, i).every((channel, axis) => Math.abs(channel - color[axis]) <= tolerance);
    }
  }
}

function isInImage(look: SceneLook, center: Vec3, isIn: (xPart: number, yPart: number) => boolean): boolean {
  const place = imagePlace(look, center);
  return place !== null && isIn((1 + place[0]) / 2, (1 - place[1]) / 2);
}

function dragTest(dragged: DragRegion, width: number, height: number): (x: number, y: number) => boolean {
  if (dragged.kind === 'rectangle') {
    const { from, to } = dragged;
    const [left, right] = [Math.min(from[0], to[0]), Math.max(from[0], to[0])];
    const [top, bottom] = [Math.min(from[1], to[1]), Math.max(from[1], to[1])];
    return (x, y) => x >= left && x <= right && y >= top && y <= bottom;
  }
  if (dragged.kind === 'polygon') return polygonTest(dragged.points);
  const painted = paintedPixels(dragged, width, height);
  return (x, y) => painted[Math.floor(y) * width + Math.floor(x)] === 1;
}

/**
 * Even–odd test: whether a ray to the right crosses the polygon an odd number of times. Points on
 * the outline count as inside.
 */
function polygonTest(points: readonly number[]): (x: number, y: number) => boolean {
  return (x, y) => {
    let isIn = false;
    let [ax, ay] = points.slice(-2);
    for (let p = 0; p < points.length; p += 2) {
      const [bx, by] = [points[p], points[p + 1]];
      const side = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
      const isBeside = x >= Math.min(ax, bx) && x <= Math.max(ax, bx);
      if (side === 0 && isBeside && y >= Math.min(ay, by) && y <= Math.max(ay, by)) return true;
      if (ay > y !== by > y && side > 0 === by > ay) isIn = !isIn;
      [ax, ay] = [bx, by];
    }
    return isIn;
  };
}

/**
 * 1 for each pixel that the brush has touched: the time of a lookup does not depend on the stroke.
 */
function paintedPixels(
  { points, radius }: Extract<DragRegion, { kind: 'brush' }>,
  width: number,
  height: number,
): Uint8Array {
  const painted = new Uint8Array(width * height);
  for (let p = 0; p < points.length; p += 2) {
    const [bx, by] = [points[p], points[p + 1]];
    const [ax, ay] = p === 0 ? [bx, by] : [points[p - 2], points[p - 1]];
    const [dx, dy] = [bx - ax, by - ay];
    const squared = dx * dx + dy * dy;
    const lastY = Math.min(height - 1, Math.ceil(Math.max(ay, by) + radius));
    const lastX = Math.min(width - 1, Math.ceil(Math.max(ax, bx) + radius));
    const firstX = Math.max(0, Math.floor(Math.min(ax, bx) - radius));
    for (let y = Math.max(0, Math.floor(Math.min(ay, by) - radius)); y <= lastY; y++) {
      for (let x = firstX; x <= lastX; x++) {
        const [qx, qy] = [x + 0.5 - ax, y + 0.5 - ay];
        const along = squared > 0 ? Math.min(1, Math.max(0, (qx * dx + qy * dy) / squared)) : 0;
        if (Math.hypot(qx - along * dx, qy - along * dy) <= radius) painted[y * width + x] = 1;
      }
    }
  }
  return painted;
}
