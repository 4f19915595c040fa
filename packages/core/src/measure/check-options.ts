import { InvalidArgumentError } from '../data/errors.ts';
import { CLOUD, checkKind, ENGINE, given } from '../data/given.ts';
import { shown } from '../data/printable.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { MeasuredEngine } from './measured-engine.ts';

/**
 * Checks what all measurements are asked for.
 *
 * @param counts further options that are whole numbers of at least 1.
 * @throws InvalidArgumentError naming the argument.
 */
export function checkMeasured(
  engine: MeasuredEngine,
  frame: Pick<FrameRequest, 'clouds' | 'widthPx' | 'heightPx'> & { readonly cameras?: readonly unknown[] },
  counts: Readonly<Record<string, number>> = {},
): void {
  given(engine, ENGINE, 'engine');
  const { clouds, widthPx, heightPx, cameras = [null] } = given(frame);
  for (const [name, list] of Object.entries({ cameras, clouds })) {
    checkKind(name, list, 'a list');
    if (list.length === 0) throw new InvalidArgumentError(name, `There are no ${name}; give at least one.`);
  }
  for (const [i, instance] of clouds.entries())
    given(given(instance, {}, `clouds[${i}]`).cloud, CLOUD, `clouds[${i}].cloud`);
  for (const [name, value] of Object.entries({ widthPx, heightPx, ...counts })) {
    if (Number.isInteger(value) && value >= 1) continue;
    const message = `${name} is ${shown(value)}; it must be a whole number of at least 1.`;
    throw new InvalidArgumentError(name, message);
  }
}
