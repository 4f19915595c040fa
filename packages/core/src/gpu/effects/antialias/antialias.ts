import { ANTIALIAS_DILATION_PX2, DILATION_PX2 } from '../../../data/accuracy/accuracy.ts';
import { given, wrongArgument } from '../../../data/given.ts';
import { effectFunction } from '../effect.ts';
import { EFFECT_LIST } from '../effect-list.ts';
import wgsl from './antialias.wgsl?raw';

/** Options of `antialias`. */
export interface AntialiasOptions {
  /**
   * Variance of the low-pass filter that every splat is drawn with, px², 0.01…1. Default: 0.3, as
   * gsplat's `antialiased` mode trains, if the file says that it was trained with antialiasing; else
   * 0.1, with which pictures are nearest to supersampled ones. Mip-Splatting trains with 0.1, too.
   */
  readonly dilationPx2?: number;
}

const RANGE_PX2 = [0.01, 1] as const;

/**
 * Multiplies every splat's opacity by √(det Σ / det Σ′), where Σ is its covariance on the screen
 * and Σ′ is Σ with the dilation that it is drawn with: splats thinner than a pixel become fainter,
 * not only wider. The dilation is then a low-pass filter, and may be narrower than the 0.3 px² of
 * scenes without antialiasing. Scenes trained with antialiasing (Mip-Splatting, gsplat's
 * `antialiased`) expect it; others become fainter than they were trained to be near by, and nearer
 * to their supersampled pictures from afar. It is on automatically for clouds whose file says that
 * they were trained so, unless `antialias(false)` is among their effects.
 *
 * @throws InvalidArgumentError for anything but true, false or a width in its range.
 * @example
 * // Filters as Mip-Splatting does in training, whatever the file says.
 * const clouds = [{ cloud, effects: [antialias({ dilationPx2: 0.1 })] }];
 */
export const antialias = /* @__PURE__ */ effectFunction<boolean | AntialiasOptions | undefined>({
  ...EFFECT_LIST.antialias,
  wgsl,
  check(options = true) {
    if (typeof options === 'boolean') return;
    if (typeof options !== 'object' || options === null)
      throw wrongArgument('antialias', options, 'true, false or { dilationPx2 }');
    const { dilationPx2 } = given(options, { dilationPx2: 'a number?' }, 'antialias');
    const [least, most] = RANGE_PX2;
    if (dilationPx2 !== undefined && !(dilationPx2 >= least && dilationPx2 <= most))
      throw wrongArgument('dilationPx2', dilationPx2, `a variance of ${least} to ${most} px²`);
  },
  calledFor(options = true) {
    if (options === false) return null;
    const { dilationPx2 = ANTIALIAS_DILATION_PX2 } = options === true ? {} : options;
    return dilationPx2 === DILATION_PX2
      ? `scenes trained with antialiasing expect it, at ${dilationPx2} px²`
      : `splats are filtered by ${dilationPx2} px², as supersampling would`;
  },
});
