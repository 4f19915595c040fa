import type { ShaderMutation } from '@websplatter/core/inspect';

/** A remedy of the shaders, switched off as renderers that lack it would be written. */
export interface Mutation extends ShaderMutation {
  /** What is switched off: kebab-case, unique. */
  readonly remedy: string;
  /** Cases of the catalogue of which at least one has to fail then. */
  readonly cases: readonly string[];
}

/** One entry per remedy. */
export const MUTATIONS: readonly Mutation[] = [
  {
    remedy: 'gram-determinant',
    file: 'lib/covariance',
    find: 'let determinant = dot(normal, normal) + dilation * (xx + yy) + dilation * dilation;',
    replace: 'let determinant = (xx + dilation) * (yy + dilation) - dot(x, y) * dot(x, y) + 0.0 * normal.x;',
    cases: [],
  },
  {
    remedy: 'power-of-two-unit',
    file: 'lib/covariance',
    find: 'let unitPx = bitcast<f32>(bitcast<u32>(max(1.0, largest)) & 0x7f800000u);',
    replace: 'let unitPx = 1.0 + 0.0 * min(largest, 1.0);',
    cases: [],
  },
  {
    remedy: 'minor-eigenvalue-by-determinant',
    file: 'lib/covariance',
    find: 'let smaller = covariance.determinant / larger;',
    replace:
      'let smaller = max(0.0, 0.5 * (a + c) - sqrt(halfDifference * halfDifference + b * b) + 0.0 * covariance.determinant);',
    cases: [],
  },
  {
    remedy: 'longer-eigenvector',
    file: 'lib/covariance',
    find: 'let direction = select(second, first, dot(first, first) > dot(second, second));',
    replace: 'let direction = select(first, second, false);',
    cases: [],
  },
  {
    remedy: 'circle-guard',
    file: 'lib/covariance',
    find: 'let unit = select(vec2f(1.0, 0.0), direction * inverseSqrt(max(length2, 1e-37)), length2 > 1e-37);',
    replace: 'let unit = direction * inverseSqrt(length2);',
    cases: [],
  },
  {
    remedy: 'longest-axis',
    file: 'lib/covariance',
    find: 'unit * min(sqrt(2.0 * larger) * covariance.unitPx, LONGEST_AXIS_PX),',
    replace: 'unit * (sqrt(2.0 * larger) * covariance.unitPx),',
    cases: [],
  },
  {
    remedy: 'shortest-axis',
    file: 'lib/covariance',
    find: 'clamp(sqrt(2.0 * smaller) * covariance.unitPx, shortestPx, LONGEST_AXIS_PX),',
    replace: 'sqrt(2.0 * smaller) * covariance.unitPx + 0.0 * shortestPx,',
    cases: [],
  },
  {
    remedy: 'jacobian-clamp-x',
    file: 'lib/covariance',
    find: 'let tangentX = clamp(centerView.x * inverseDepth, view.clampX.x, view.clampX.y);',
    replace: 'let tangentX = centerView.x * inverseDepth;',
    cases: [],
  },
  {
    remedy: 'jacobian-clamp-y',
    file: 'lib/covariance',
    find: 'let tangentY = clamp(centerView.y * inverseDepth, view.clampY.x, view.clampY.y);',
    replace: 'let tangentY = centerView.y * inverseDepth;',
    cases: [],
  },
  {
    remedy: 'quad-clipped-to-viewport',
    file: 'stages/rasterize',
    find: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox);',
    replace: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox && false);',
    cases: [],
  },
  {
    remedy: 'snapped-corners',
    file: 'stages/rasterize',
    find: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox);',
    replace: 'let cornerPx = select(oriented, box, isBox);',
    cases: [],
  },
  {
    remedy: 'greatest-fragment-alpha',
    file: 'stages/rasterize',
    find: 'let alpha = min(MAX_FRAGMENT_ALPHA, color.w * exp(-dot(varyings.local, varyings.local)));',
    replace:
      'let alpha = min(MAX_FRAGMENT_ALPHA + 0.01, color.w * exp(-dot(varyings.local, varyings.local)));',
    cases: [],
  },
  {
    remedy: 'fragment-cutoff',
    file: 'stages/rasterize',
    find: 'alpha >= view.alphaCutoff);',
    replace: 'alpha >= 0.0);',
    cases: [],
  },
  {
    remedy: 'color-clamped-at-zero',
    file: 'stages/project',
    find: 'let rgba = vec4f(max(color, vec3f(0.0)), splat.opacity);',
    replace: 'let rgba = vec4f(color, splat.opacity);',
    cases: [],
  },
  {
    remedy: 'direction-fallback',
    file: 'stages/project',
    find: 'if (!(largest > 1e-37)) { return vec3f(0.0, 0.0, 1.0); }',
    replace: '',
    cases: [],
  },
  {
    remedy: 'direction-scaled-first',
    file: 'stages/project',
    find: 'return normalize(toward / largest);',
    replace: 'return normalize(toward);',
    cases: [],
  },
  {
    remedy: 'near-plane-by-center',
    file: 'lib/visible-ellipse',
    find: 'return depthView > view.near && depthView <= view.far;',
    replace: 'return depthView <= view.far;',
    cases: [],
  },
  {
    remedy: 'visible-extent-not-center',
    file: 'stages/cull-splats',
    find: 'let extent = extentPx(onScreen.covariance, reachInAxes(splat.opacity, view.alphaCutoff));',
    replace:
      'let extent = vec2f(0.0) * extentPx(onScreen.covariance, reachInAxes(splat.opacity, view.alphaCutoff));',
    cases: [],
  },
  {
    remedy: 'keys-of-negative-depths',
    file: 'lib/depth-key',
    find: 'return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);',
    replace: 'return bits;',
    cases: [],
  },
  {
    remedy: 'stable-scatter',
    file: 'stages/sort-scatter',
    find: 'rank = countOneBits(atomicLoad(&masks[word * RADIX + digit]) & (bit - 1u));',
    replace: 'rank = countOneBits(atomicLoad(&masks[word * RADIX + digit]) & ~((bit << 1u) - 1u));',
    cases: [],
  },
  {
    remedy: 'compaction-in-storage-order',
    file: 'stages/compact-splats',
    find: 'var rank = countOneBits(bits & (bit - 1u));',
    replace: 'var rank = countOneBits(bits & ~((bit << 1u) - 1u));',
    cases: [],
  },
  {
    remedy: 'rows-of-workgroups',
    file: 'lib/dispatch',
    find: 'return workgroup.y * row + workgroup.x;',
    replace: 'return workgroup.x + 0u * row;',
    cases: [],
  },
];
