import { createElement, Suspense } from 'react';
import { renderToString } from 'react-dom/server';
import { expect, it } from 'vitest';
import { isSupported, SplatCanvas, Splats, SplatsFallback, StageTimings, useSplats } from './index.ts';

it('renders a page on a server', async () => {
  useSplats.preload('garden.ply');
  const canvas = createElement(SplatCanvas, { flat: true }, createElement(Splats, { src: 'garden.ply' }));
  const page = createElement(
    SplatsFallback,
    null,
    canvas,
    createElement(Splats, { src: 'garden.ply' }),
    createElement(StageTimings, { renderer: null }),
  );
  expect(renderToString(page)).toMatch(/^<div.*<canvas.*<\/canvas>.*<\/div>$/);
  expect(await isSupported()).toBe(false);
});

it('leaves components that need a file to the browser', () => {
  function Count() {
    return useSplats('garden.ply').count;
  }
  const page = createElement(Suspense, { fallback: 'Loading' }, createElement(Count));
  expect(renderToString(page)).toContain('Loading');
});
