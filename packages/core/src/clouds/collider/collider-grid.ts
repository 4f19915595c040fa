import type { Vec3 } from '../../data/math/mat4.ts';
import type { GeometryPiece } from '../geometry-pieces.ts';
import { areaOf, COVARIANCE, OPACITY, SHAPE_VALUES, SIZE, shapeReader } from '../splat-shape.ts';

/** The nodes of a regular grid at which a cloud is sampled. */
export interface GridPlan {
  /** Position of the first node, in the space of the geometry. */
  readonly start: Vec3;
  /** Nodes along x, y and z, at least 3. */
  readonly size: Vec3;
  /** Length of a cell's edge, world units. */
  readonly cellSize: number;
}

/**
 * Standard deviation of the blur on splats, in cells. With it, the nodes on both sides of a sheet
 * thinner than a cell detect it at any position between them. Half a cell away, a third of its
 * depth is left.
 */
const BLUR_CELLS = 0.35;
/** Optical depth below which a splat, or its contribution to a node, is left out. */
const LEAST_DEPTH = 0.02;
/**
 * Least squared reach of a blurred splat, in standard deviations, however small its contributions
 * are. A surface of splats far smaller than a cell has thousands of them.
 */
const LEAST_REACH = 4;
/** Opacity of a splat is clamped to this, as in drawing. */
const MOST_ALPHA = 0.99;
/**
 * Splats with a larger standard deviation, as a share of the grid's longest side, are taken for sky
 * or haze.
 */
const MOST_SIZE = 0.5;

/** Optical depth of a cloud at the nodes of a grid: 4 bytes each. */
export class ColliderGrid {
  readonly plan: GridPlan;
  /**
   * Optical depth −ln(1 − opacity) per node, x fastest. Outermost nodes stay 0, so that surfaces
   * close.
   */
  readonly depths: Float32Array;
  readonly #shape = new Float64Array(SHAPE_VALUES);

  constructor(plan: GridPlan) {
    this.plan = plan;
    this.depths = new Float32Array(plan.size[0] * plan.size[1] * plan.size[2]);
  }

  /** Adds splats `from`…`end` of `geometry`. Equal splats in equal order give equal grids. */
  add(geometry: GeometryPiece, from: number, end: number): void {
    const read = shapeReader(geometry);
    const { cellSize, size } = this.plan;
    const largest = MOST_SIZE * cellSize * Math.max(...size);
    for (let i = from; i < end; i++) {
      if (read(i, this.#shape, 0) && this.#shape[SIZE] <= largest) this.#addShape();
    }
  }

  #addShape(): void {
    const shape = this.#shape;
    const { start, size, cellSize } = this.plan;
    const opacity = Math.min(MOST_ALPHA, shape[OPACITY]);
    if (depthOf(opacity) < LEAST_DEPTH) return;
    const area = areaOf(shape, COVARIANCE);
    const blur = (BLUR_CELLS * cellSize) ** 2;
    for (let axis = 0; axis < 3; axis++) shape[COVARIANCE + axis] += blur;
    // The blurred splat is larger: its opacity is scaled down to cover as much as before.
    const depth = depthOf((opacity * area) / areaOf(shape, COVARIANCE));
    // Squared distance in standard deviations within which the splat contributes.
    const reach = Math.max(LEAST_REACH, 2 * Math.log(depth / LEAST_DEPTH));

    const xx = shape[COVARIANCE];
    const yy = shape[COVARIANCE + 1];
    const zz = shape[COVARIANCE + 2];
    const xy = shape[COVARIANCE + 3];
    const xz = shape[COVARIANCE + 4];
    const yz = shape[COVARIANCE + 5];
    // The inverse of the covariance, in cells.
    const perCells =
      (cellSize * cellSize) /
      (xx * (yy * zz - yz * yz) - xy * (xy * zz - xz * yz) + xz * (xy * yz - xz * yy));
    const qxx = (yy * zz - yz * yz) * perCells;
    const qyy = (xx * zz - xz * xz) * perCells;
    const qzz = (xx * yy - xy * xy) * perCells;
    const qxy = (xz * yz - xy * zz) * perCells;
    const qxz = (xy * yz - xz * yy) * perCells;
    const qyz = (xy * xz - xx * yz) * perCells;

    const cx = (shape[0] - start[0]) / cellSize;
    const cy = (shape[1] - start[1]) / cellSize;
    const cz = (shape[2] - start[2]) / cellSize;
    const reachY = Math.sqrt(reach * yy) / cellSize;
    const reachZ = Math.sqrt(reach * zz) / cellSize;
    const lastY = Math.min(size[1] - 2, Math.floor(cy + reachY));
    const lastZ = Math.min(size[2] - 2, Math.floor(cz + reachZ));
    for (let z = Math.max(1, Math.ceil(cz - reachZ)); z <= lastZ; z++) {
      const dz = z - cz;
      for (let y = Math.max(1, Math.ceil(cy - reachY)); y <= lastY; y++) {
        const dy = y - cy;
        // Along x the squared distance is qxx·dx² + 2·half·dx + rest.
        const half = qxy * dy + qxz * dz;
        const rest = qyy * dy * dy + 2 * qyz * dy * dz + qzz * dz * dz;
        const discriminant = half * half - qxx * (rest - reach);
        if (!(discriminant > 0)) continue;
        const root = Math.sqrt(discriminant);
        const lastX = Math.min(size[0] - 2, Math.floor(cx + (root - half) / qxx));
        const row = (z * size[1] + y) * size[0];
        for (let x = Math.max(1, Math.ceil(cx - (root + half) / qxx)); x <= lastX; x++) {
          const dx = x - cx;
          this.depths[row + x] += depth * Math.exp(-0.5 * ((qxx * dx + 2 * half) * dx + rest));
        }
      }
    }
  }
}

/** Optical depth of an opacity. */
function depthOf(opacity: number): number {
  return -Math.log(1 - opacity);
}
