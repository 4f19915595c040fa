import { checkKind } from '../given.ts';
import { ACCURACY_SETTINGS, type Accuracy, type AccuracySettings, resolveAccuracy } from './accuracy.ts';
import { type AccuracyRequest, isAccuracyTarget } from './accuracy-target.ts';

/**
 * Combines the accuracy requests of a frame's clouds into one. In order of precedence: the highest
 * `minPsnrDb`; the requested settings, each at its most exact value; the lowest `maxFrameMs`.
 * Returns undefined if no cloud requests anything.
 *
 * @hidden Shared with the packages beside this one.
 * @throws InvalidArgumentError for unknown settings.
 */
export function combineAccuracies(requests: readonly AccuracyRequest[]): AccuracyRequest | undefined {
  checkKind('requests', requests, 'a list');
  const targets = requests.filter(isAccuracyTarget);
  const [clearest] = targets
    .filter((target) => 'minPsnrDb' in target)
    .sort((a, b) => b.minPsnrDb - a.minPsnrDb);
  if (clearest) return clearest;
  const settings = requests.filter((request): request is Accuracy => !isAccuracyTarget(request));
  if (settings.length > 0) return settings.length === 1 ? settings[0] : mostExact(settings);
  const [fastest] = targets
    .filter((target) => 'maxFrameMs' in target)
    .sort((a, b) => a.maxFrameMs - b.maxFrameMs);
  return fastest;
}

/**
 * Returns each setting at its most exact value in `accuracies`, which has at least one entry.
 *
 * @hidden Shared with the packages beside this one.
 */
export function mostExact(accuracies: readonly Accuracy[]): AccuracySettings {
  checkKind('accuracies', accuracies, 'a list');
  const asked = accuracies.map((accuracy) => resolveAccuracy(accuracy));
  const chosen = Object.entries(ACCURACY_SETTINGS).map(([name, { values }]) => {
    const found: unknown[] = asked.map((settings) => settings[name as keyof AccuracySettings]);
    if ('min' in values) {
      const exact = name === 'resolutionScale' ? Math.max : Math.min;
      return [name, exact(...(found as number[]))];
    }
    return [name, values.find((value) => found.includes(value))];
  });
  return Object.fromEntries(chosen) as AccuracySettings;
}
