import {
  ACCURACY_SETTINGS,
  type AccuracySetting,
  DEFAULT_ACCURACY,
  resolveAccuracy,
} from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { SETTING_NAMES } from '../state/accuracy.ts';
import { defaultAccuracyOn } from './viewer.ts';

describe('the default accuracy of a device', () => {
  it('is the engine’s on a GPU', () => {
    expect(defaultAccuracyOn(false)).toEqual(resolveAccuracy(DEFAULT_ACCURACY));
  });

  it('is nowhere less exact on a CPU', () => {
    const [usual, onCpu] = [resolveAccuracy(), defaultAccuracyOn(true)];
    expect(onCpu).not.toEqual(usual);
    for (const name of SETTING_NAMES) {
      const { values }: AccuracySetting<unknown> = ACCURACY_SETTINGS[name];
      if ('min' in values) expect(onCpu[name], name).toBe(usual[name]);
      else expect(values.indexOf(onCpu[name]), name).toBeLessThanOrEqual(values.indexOf(usual[name]));
    }
  });
});
