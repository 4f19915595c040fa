import { InvalidArgumentError } from '../data/errors.ts';
import { CLOUD, checkKind, ENGINE, given, wrongArgument } from '../data/given.ts';
import { checkDetail, isFixedDetail } from '../frame/plan/detail.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { MeasuredEngine } from './measured-engine.ts';

/**
 * Checks the options that all measurements share.
 *
 * @param counts further options that are whole numbers of at least 1.
 * @throws InvalidArgumentError naming the argument.
 */
export function checkMeasured(
  engine: MeasuredEngine,
  frame: Pick<FrameRequest, 'clouds' | 'widthPx' | 'heightPx' | 'detail'> & {
    readonly cameras?: readonly unknown[];
  },
  counts: Readonly<Record<string, number>> = {},
): void {
  given(engine, ENGINE, 'engine');
  const { clouds, widthPx, heightPx, cameras = [null], detail = 'full' } = given(frame);
  for (const [name, list] of Object.entries({ cameras, clouds })) {
    checkKind(name, list, 'a list');
    if (list.length === 0) throw new InvalidArgumentError(name, `There are no ${name}; give at least one.`);
  }
  checkClouds(clouds);
  checkDetail(detail);
  // Views adapt other details from frame to frame, so frames could not be compared.
  if (!isFixedDetail(detail))
    throw wrongArgument('detail', detail, "'full' or limits, for instance those of view.detail.drawn");
  checkCounts({ widthPx, heightPx, ...counts });
}

/** @throws InvalidArgumentError naming the first entry that is not a cloud on a GPU. */
export function checkClouds(clouds: FrameRequest['clouds']): void {
  checkKind('clouds', clouds, 'a list');
  for (const [i, instance] of clouds.entries())
    given(given(instance, {}, `clouds[${i}]`).cloud, CLOUD, `clouds[${i}].cloud`);
}

/** @throws InvalidArgumentError naming the first count that is not a whole number of at least 1. */
export function checkCounts(counts: Readonly<Record<string, number>>): void {
  for (const [name, value] of Object.entries(counts)) {
    if (Number.isInteger(value) && value >= 1) continue;
    throw wrongArgument(name, value, 'a whole number of at least 1');
  }
}
