import {
  ACCURACY_SETTINGS,
  type Accuracy,
  type AccuracyRequest,
  type AccuracySettings,
  isAccuracyWish,
  resolveAccuracy,
} from '@websplatter/core';

/**
 * What a picture of several clouds is drawn with, of what they ask for: the most decibels that any wishes for; else
 * settings, each at the most exact value that any asks for; else the shortest time. Undefined where none asks for anything.
 *
 * @throws InvalidArgumentError for unknown settings.
 */
export function pictureAccuracy(requests: readonly AccuracyRequest[]): AccuracyRequest | undefined {
  const decibels: number[] = [];
  const milliseconds: number[] = [];
  const settings: Accuracy[] = [];
  for (const request of requests) {
    if (!isAccuracyWish(request)) settings.push(request);
    else if ('minPsnrDb' in request) decibels.push(request.minPsnrDb);
    else milliseconds.push(request.maxFrameMs);
  }
  if (decibels.length > 0) return { minPsnrDb: Math.max(...decibels) };
  if (settings.length > 0) return settings.length === 1 ? settings[0] : mostExact(settings);
  return milliseconds.length > 0 ? { maxFrameMs: Math.min(...milliseconds) } : undefined;
}

/** Each setting at the most exact value that one of `accuracies`, of which there is at least one, has. */
export function mostExact(accuracies: readonly Accuracy[]): AccuracySettings {
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
