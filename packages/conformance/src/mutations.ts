import type { FrameRasterizer } from '@websplatter/core';
import type { ShaderMutation } from '@websplatter/core/inspect';

/** A remedy of the shaders, switched off: the shader of a renderer without the remedy. */
export interface Mutation extends ShaderMutation {
  /** Name of the remedy: kebab-case, unique. */
  readonly remedy: string;
  /** Cases of the catalogue, at least one of which must fail without the remedy. */
  readonly cases: readonly string[];
  /** The only rasteriser that needs the remedy. Default: both need it. */
  readonly rasterizer?: FrameRasterizer;
  /** Why GPUs may do without the remedy, so that only the software adapter has to fail. */
  readonly spareOnGpus?: string;
}

/** One entry per remedy. */
export const MUTATIONS: readonly Mutation[] = [
  {
    remedy: 'gram-determinant',
    file: 'lib/covariance',
    find: 'let determinant = undilated + dilation * (xx + yy) + dilation * dilation;',
    replace: 'let determinant = (xx + dilation) * (yy + dilation) - dot(x, y) * dot(x, y) + 0.0 * undilated;',
    cases: ['needle-aspect-1e6', 'scale-screen-axis-7e4-px'],
  },
  {
    remedy: 'power-of-two-unit',
    file: 'lib/covariance',
    find: 'let unitPx = bitcast<f32>(bitcast<u32>(max(1.0, largest)) & 0x7f800000u);',
    replace: 'let unitPx = 1.0 + 0.0 * min(largest, 1.0);',
    cases: ['scale-log-40', 'scale-log-40-one-axis'],
  },
  {
    remedy: 'minor-eigenvalue-by-determinant',
    file: 'lib/covariance',
    find: 'let smaller = covariance.determinant / larger;',
    replace:
      'let smaller = max(0.0, 0.5 * (a + c) - sqrt(halfDifference * halfDifference + b * b) + 0.0 * covariance.determinant);',
    cases: ['needle-aspect-1e6'],
  },
  {
    remedy: 'longer-eigenvector',
    file: 'lib/covariance',
    find: 'let direction = select(second, first, dot(first, first) > dot(second, second));',
    replace: 'let direction = select(first, second, false);',
    cases: ['needles-almost-axis-aligned'],
  },
  {
    remedy: 'circle-guard',
    file: 'lib/covariance',
    find: 'let unit = select(vec2f(1.0, 0.0), direction * inverseSqrt(max(length2, 1e-37)), length2 > 1e-37);',
    replace: 'let unit = direction * inverseSqrt(length2);',
    cases: ['scale-zero-all', 'scale-log-minus-40'],
  },
  {
    remedy: 'longest-axis',
    file: 'lib/covariance',
    find: 'unit * min(sqrt(2.0 * larger) * covariance.unitPx, LONGEST_AXIS_PX),',
    replace: 'unit * (sqrt(2.0 * larger) * covariance.unitPx),',
    cases: ['scale-log-88', 'input-scale-3e38'],
  },
  {
    remedy: 'shortest-axis',
    file: 'lib/covariance',
    find: 'clamp(sqrt(2.0 * smaller) * covariance.unitPx, shortestPx, LONGEST_AXIS_PX),',
    replace: 'sqrt(2.0 * smaller) * covariance.unitPx + 0.0 * shortestPx,',
    cases: ['scale-log-40'],
  },
  {
    remedy: 'jacobian-clamp-x',
    file: 'lib/covariance',
    find: 'let tangentX = clamp(centerView.x * inverseDepth, view.clampX.x, view.clampX.y);',
    replace: 'let tangentX = centerView.x * inverseDepth;',
    cases: ['camera-off-centre-axis-outside'],
  },
  {
    remedy: 'jacobian-clamp-y',
    file: 'lib/covariance',
    find: 'let tangentY = clamp(centerView.y * inverseDepth, view.clampY.x, view.clampY.y);',
    replace: 'let tangentY = centerView.y * inverseDepth;',
    cases: ['camera-off-centre-axis-outside'],
  },
  {
    remedy: 'quad-clipped-to-viewport',
    file: 'stages/rasterize',
    find: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox);',
    replace: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox && false);',
    cases: ['scale-log-40'],
    rasterizer: 'quads',
    spareOnGpus: 'an NVIDIA H200 was seen to rasterise corners at 1e18 px, which SwiftShader cannot',
  },
  {
    remedy: 'snapped-corners',
    file: 'stages/rasterize',
    find: 'let cornerPx = select(round(oriented / SNAP_PX) * SNAP_PX, box, isBox);',
    replace: 'let cornerPx = select(oriented, box, isBox);',
    cases: ['scale-points-between-pixels'],
    rasterizer: 'quads',
    spareOnGpus: 'SwiftShader snaps corners to 1/16 px, most GPUs to 1/256 px',
  },
  {
    remedy: 'greatest-fragment-alpha',
    file: 'lib/splat-record',
    find: 'let capped = min(MAX_FRAGMENT_ALPHA, alpha);',
    replace: 'let capped = min(MAX_FRAGMENT_ALPHA + 0.01, alpha);',
    cases: ['accumulate-60-layers-alpha-0-99'],
  },
  {
    remedy: 'fragment-cutoff',
    file: 'lib/splat-record',
    find: 'return select(0.0, capped, capped >= alphaCutoff);',
    replace: 'return select(0.0, capped, capped >= 0.0 * alphaCutoff);',
    cases: ['accumulate-600-edges'],
  },
  {
    remedy: 'color-clamped-at-zero',
    file: 'stages/project',
    find: 'let rgba = vec4f(clamp(color, vec3f(0.0), vec3f(MAX_COLOR)), opacity);',
    replace: 'let rgba = vec4f(min(color, vec3f(MAX_COLOR)), opacity);',
    cases: ['colour-negative'],
  },
  {
    remedy: 'color-clamped-at-the-target',
    file: 'stages/project',
    find: 'let rgba = vec4f(clamp(color, vec3f(0.0), vec3f(MAX_COLOR)), opacity);',
    replace: 'let rgba = vec4f(clamp(color, vec3f(0.0), vec3f(1e38) + f32(MAX_COLOR)), opacity);',
    cases: ['device-no-float32-blendable'],
  },
  {
    remedy: 'one-key-for-both-zeros',
    file: 'lib/depth-key',
    find: 'let bits = select(given, 0u, (given & 0x7fffffffu) == 0u);',
    replace: 'let bits = given;',
    cases: ['depth-negative-zero'],
  },
  {
    remedy: 'distance-scaled-first',
    file: 'lib/depth-key',
    find: 'let units = min(abs(toward) * scale, vec3f(1e19));',
    replace: 'let units = toward;',
    cases: ['depth-order-of-distances-of-1e20', 'depth-order-of-distances-of-1e-20'],
  },
  {
    remedy: 'direction-fallback',
    file: 'stages/project',
    find: 'if (!(largest > 1e-37)) { return vec3f(0.0, 0.0, 1.0); }',
    replace: '',
    cases: ['model-singular-flat-seen-obliquely', 'model-singular-seen-edge-on'],
  },
  {
    remedy: 'direction-scaled-first',
    file: 'stages/project',
    find: 'return normalize(toward / largest);',
    replace: 'return normalize(toward);',
    cases: ['colour-direction-of-length-1e-20'],
  },
  {
    remedy: 'near-plane-by-center',
    file: 'lib/visible-ellipse',
    find: 'return depthView > view.near && depthView <= view.far;',
    replace: 'return depthView <= view.far;',
    cases: ['depth-behind-the-camera', 'depth-at-near'],
  },
  {
    remedy: 'visible-extent-not-center',
    file: 'stages/cull-splats',
    find: 'let extent = extentPx(onScreen.covariance, reachInAxes(opacity, view.alphaCutoff));',
    replace:
      'let extent = vec2f(0.0) * extentPx(onScreen.covariance, reachInAxes(opacity, view.alphaCutoff));',
    cases: ['camera-fov-1', 'camera-off-centre'],
  },
  {
    remedy: 'keys-of-float64',
    file: 'stages/wide-keys',
    find: 'keys[index] = ~words.x;',
    replace: 'keys[index] = 0u * words.x;',
    cases: ['depth-slab-thinner-than-a-step-of-float32'],
  },
  {
    remedy: 'distances-in-float64',
    file: 'stages/wide-keys',
    find: 'keys[index] = ~words.x;',
    replace: 'keys[index] = ~words.x & 0xe0000000u;',
    cases: ['depth-shell-thinner-than-a-step-of-float32'],
  },
  {
    remedy: 'rounding-of-float64',
    file: 'lib/float64',
    find: 'let low = significand.x + 0x200u;',
    replace: 'let low = significand.x;',
    cases: ['depth-lattice-from-its-corner'],
  },
  {
    remedy: 'keys-of-negative-depths',
    file: 'lib/depth-key',
    find: 'return bits ^ select(0x80000000u, 0xffffffffu, (bits & 0x80000000u) != 0u);',
    replace: 'return bits;',
    cases: ['depth-either-side-of-zero', 'camera-orthographic-negative-near'],
  },
  {
    remedy: 'stable-scatter',
    file: 'stages/sort-scatter',
    find: 'for (var index = start; index < end; index++) {\n    let key = keysIn[index];',
    replace:
      'for (var step = start; step < end; step++) {\n    let index = start + end - 1u - step;\n    let key = keysIn[index];',
    cases: ['sort-few-distinct-24-bits'],
    spareOnGpus: 'one thread sorts a block where few run in lockstep',
  },
  {
    remedy: 'compaction-in-storage-order',
    file: 'stages/compact-splats',
    find: 'var rank = countOneBits(bits & (bit - 1u));',
    replace: 'var rank = countOneBits(bits & ~((bit << 1u) - 1u));',
    cases: ['counts-257'],
  },
  {
    remedy: 'rows-of-workgroups',
    file: 'lib/dispatch',
    find: 'return workgroup.y * row + workgroup.x;',
    replace: 'return workgroup.x + 0u * row;',
    cases: ['counts-1793-in-rows-of-7', 'sort-32257-keys-in-rows-of-7'],
  },
  {
    remedy: 'quads-give-way-to-tiles',
    file: 'stages/tile-plan',
    find: 'select(visibleCount, 0u, fits)',
    replace: 'visibleCount',
    cases: ['tiles-splats-in-all'],
    rasterizer: 'tiles',
  },
  {
    remedy: 'widest-point-of-an-ellipse-in-a-row',
    file: 'lib/splat-ellipse',
    find: 'let atRight = clamp(ellipse.rightmostPx, low, high);',
    replace: 'let atRight = 0.5 * (low + high);',
    cases: ['tiles-needles-across'],
    rasterizer: 'tiles',
  },
  {
    remedy: 'pairs-of-no-other-bin',
    file: 'lib/tile-blend',
    find: 'return mask & (0xffffffffu << before) & (0xffffffffu >> behind);',
    replace: 'return mask & (0xffffffffu | before | behind);',
    cases: ['tiles-splats-in-all'],
    rasterizer: 'tiles',
  },
  {
    remedy: 'pixels-end-late',
    file: 'lib/tile-blend',
    find: 'const OPAQUE = 0.0000152587890625;',
    replace: 'const OPAQUE = 0.02;',
    cases: ['tiles-bright-behind-almost-opaque'],
    rasterizer: 'tiles',
  },
  {
    remedy: 'number-of-an-entry-by-its-half-word',
    file: 'stages/project',
    find: 'entry = (entry >> (16u * (splatIndex % 2u))) & 0xffffu;',
    replace: 'entry = entry & 0xffffu;',
    cases: ['palette-degree-1', 'palette-degree-2', 'palette-degree-3'],
  },
  {
    remedy: 'numbers-of-entries-without-a-sign',
    file: 'stages/project',
    find: 'entry = (entry >> (16u * (splatIndex % 2u))) & 0xffffu;',
    replace: 'entry = (entry >> (16u * (splatIndex % 2u))) & 0x7fffu;',
    cases: ['palette-of-65536-entries'],
  },
  {
    remedy: 'harmonics-along-the-world',
    file: 'stages/project',
    find: 'let fromCamera = page.sight * (position - page.camera);',
    replace: 'let fromCamera = (position - page.camera) + 0.0 * page.sight[0];',
    cases: ['placement-uneven-colours', 'placement-sheared-colours'],
  },
];
