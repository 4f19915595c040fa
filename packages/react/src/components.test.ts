import { InvalidArgumentError } from '@websplatter/core';
import { createElement } from 'react';
import { renderToString } from 'react-dom/server';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { SplatAnnotation, SplatBounds, SplatMeasure, useSplatBounds } from './components.ts';

beforeEach(() => vi.stubGlobal('document', {}));
afterEach(() => vi.unstubAllGlobals());

it.each([
  ['hideAt is 0;', () => createElement(SplatAnnotation, { hideAt: 0 })],
  ['hideAt is 1.5;', () => createElement(SplatAnnotation, { hideAt: 1.5 })],
  ['tolerance is -1;', () => createElement(SplatAnnotation, { tolerance: -1 })],
  ['fullSizeDistance is 0;', () => createElement(SplatAnnotation, { fullSizeDistance: 0 })],
  ['margin is 0;', () => createElement(SplatBounds, { margin: 0 })],
  ['perWorldUnit is -1;', () => createElement(SplatMeasure, { unit: { perWorldUnit: -1 } })],
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
