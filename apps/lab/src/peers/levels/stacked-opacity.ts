import { defineEffect } from '@websplatter/core/effects';

/**
 * Opacities of any size, from splats that have them by `storedOpacity`. Frames draw stacks only where
 * they have a cut: with the detail of `EVERY_SPLAT`.
 */
export const stackedOpacity = defineEffect<undefined>({
  name: 'stacked-opacity',
  label: 'Stacked opacity',
  about: 'Draws merged splats, whose opacities are above 1.',
  hooks: { splat: 'stackSplat' },
  wgsl: `import package::lib::packing::Splat;

fn stackSplat(splat: Splat, splatIndex: u32) -> Splat {
  var stacked = splat;
  stacked.opacity = splat.opacity / (1.0 - splat.opacity);
  return stacked;
}
`,
  calledFor: () => 'another project has merged its splats',
  // The largest stacks, of 6,840 splats, reach 1.6 times as far as opaque splats.
  reach: () => ({ displacement: 0, growth: 1.7 }),
});

/** A cut through levels that draws each splat, as no error is as small. */
export const EVERY_SPLAT = { maxErrorPx: 1e-9 };

/**
 * The opacity to store for a node of Spark's, from its code. Codes above 1 stand for the radius to
 * which a stack of opaque splats looks filled. Spark's shader draws 1 − (1 − g)^opacity.
 */
export function storedOpacity(code: number): number {
  const radius = Math.min(4 * code - 3, 5);
  const opacity = code <= 1 ? code : Math.exp((radius ** 2 - 1) / Math.E);
  return opacity / (1 + opacity);
}
