import { InvalidArgumentError } from '@websplatter/core';
import { createElement } from 'react';
import { renderToString } from 'react-dom/server';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import {
  SplatAnnotation,
  SplatBounds,
  SplatInstances,
  type SplatInstancesProps,
  SplatMeasure,
  useSplatBounds,
} from './components.ts';

beforeEach(() => vi.stubGlobal('document', {}));
afterEach(() => vi.unstubAllGlobals());

const instances = (props: SplatInstancesProps) => createElement(SplatInstances, props);

it.each([
  ['hideAt is 0;', () => createElement(SplatAnnotation, { hideAt: 0 })],
  ['hideAt is 1.5;', () => createElement(SplatAnnotation, { hideAt: 1.5 })],
  ['tolerance is -1;', () => createElement(SplatAnnotation, { tolerance: -1 })],
  ['fullSizeDistance is 0;', () => createElement(SplatAnnotation, { fullSizeDistance: 0 })],
  ['margin is 0;', () => createElement(SplatBounds, { margin: 0 })],
  ['perWorldUnit is -1;', () => createElement(SplatMeasure, { unit: { perWorldUnit: -1 } })],
  ['matrices has 17 values; 1 instances take 16', () => instances({ count: 1, matrices: Array(17) })],
  ['tints has 1 values; 2 instances take 1 each', () => instances({ count: 2, tints: ['red'] })],
  ['opacities has 1 values', () => instances({ matrices: Array(32), opacities: [1] })],
  ['digits is 0.5;', () => createElement(SplatMeasure, { unit: { digits: 0.5 } })],
  ['Outside of a Canvas, <SplatAnnotation>', () => createElement(SplatAnnotation)],
  ['Outside of a Canvas, <SplatBounds>', () => createElement(SplatBounds)],
  ['Outside of a Canvas, <SplatMeasure>', () => createElement(SplatMeasure)],
  ['useSplatBounds needs a <SplatBounds>', () => createElement(() => String(useSplatBounds()))],
])('names what is wrong: %s', (message, make) => {
  const render = () => renderToString(make());
  expect(render).toThrow(InvalidArgumentError);
  expect(render).toThrow(message);
});
