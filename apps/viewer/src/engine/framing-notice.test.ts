import type { SceneFraming } from '@websplatter/core';
import { expect, test } from 'vitest';
import { framingNotice } from './framing-notice.ts';

const offersFor = (kind: SceneFraming['kind'], up: number, kindSure: number) =>
  framingNotice({ kind, confidence: { up, kind: kindSure } } as SceneFraming)?.offers.map(
    ({ command }) => command,
  );

test('what is uncertain in a first view is offered otherwise, and nothing else', () => {
  expect(offersFor('object', 0.5, 0.5)).toBeUndefined();
  expect(offersFor('object', 0.4, 0.9)).toEqual(['flip']);
  expect(offersFor('object', 0.9, 0.4)).toEqual(['inside']);
  expect(offersFor('enclosed', 0.9, 0.4)).toEqual(['outside']);
  expect(offersFor('surrounded', 0.4, 0.4)).toEqual(['outside', 'flip']);
});
