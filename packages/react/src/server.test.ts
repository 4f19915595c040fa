import { Writable } from 'node:stream';
import { createElement, Suspense } from 'react';
import { renderToPipeableStream, renderToStaticMarkup, renderToString } from 'react-dom/server';
import { prerender } from 'react-dom/static';
import { describe, expect, it } from 'vitest';
import { SplatAnnotation, SplatBounds, SplatMeasure, SplatStats } from './components.ts';
import {
  isSupported,
  SplatCanvas,
  type SplatCanvasProps,
  Splats,
  SplatsErrorBoundary,
  useSplats,
} from './index.ts';

it('renders a page on a server', async () => {
  useSplats.preload('garden.ply');
  const canvas = createElement(SplatCanvas, { flat: true }, createElement(Splats, { src: 'garden.ply' }));
  const page = createElement(
    SplatsErrorBoundary,
    null,
    canvas,
    createElement(Splats, { src: 'garden.ply' }),
    createElement(SplatStats, { renderer: null }),
    createElement(SplatAnnotation, null, 'label'),
    createElement(SplatBounds, null, createElement(Splats, { src: 'garden.ply' })),
    createElement(SplatMeasure),
  );
  expect(renderToString(page)).toMatch(/^<div.*<canvas.*<\/canvas>.*<\/div>$/);
  expect(await isSupported()).toBe(false);
});

it('renders a poster on a server: an image by its address, or an element', () => {
  const htmlOf = (props: SplatCanvasProps) => renderToStaticMarkup(createElement(SplatCanvas, props));
  const image = htmlOf({ poster: 'garden.jpg', className: 'wide', style: { height: 300 } });
  expect(image).toMatch(/<div class="wide" style="[^"]*height:300px/);
  expect(image).toContain('<img src="garden.jpg" alt="" fetchPriority="high"');
  expect(image.match(/class=/g)).toHaveLength(1);
  expect(htmlOf({ poster: 'garden.jpg', posterAlt: 'A garden' })).toContain('alt="A garden"');
  expect(htmlOf({ poster: createElement('svg') })).toContain('<svg>');
  expect(htmlOf({ poster: '' })).toBe(htmlOf({}));
});

describe('leaves components that need a file to the browser', () => {
  function Count() {
    return useSplats('garden.ply').count;
  }
  const page = createElement(Suspense, { fallback: 'Loading' }, createElement(Count));
  /** Digest by which Next tells a retry in the browser from an error, on server and page. */
  const DIGEST = 'BAILOUT_TO_CLIENT_SIDE_RENDERING';
  const errors: unknown[] = [];
  /** As in Next: the returned value goes into the page. */
  const onError = (error: unknown) => {
    errors.push(error);
    return (error as { digest?: string }).digest;
  };
  const expectFallback = (html: string) => {
    expect(html).toContain('Loading');
    expect(html).toContain(`data-dgst="${DIGEST}"`);
    expect(errors.splice(0)).toMatchObject([{ code: 'server', digest: DIGEST, reason: 'useSplats()' }]);
  };

  it('in one piece', () => {
    expect(renderToString(page)).toContain('Loading');
  });

  it('in a page that is rendered in advance', async () => {
    const { prelude } = await prerender(page, { onError });
    expectFallback(await new Response(prelude).text());
  });

  it('in a page that is streamed, which ends', async () => {
    let html = '';
    await new Promise<void>((resolve) => {
      const write = (chunk: Buffer, _: unknown, next: () => void) => {
        html += chunk;
        next();
      };
      const stream = renderToPipeableStream(page, { onError });
      stream.pipe(new Writable({ write })).once('finish', resolve);
    });
    expectFallback(html);
  });

  it('and asks for no file where there is none', () => {
    const None = () => String(useSplats(null));
    expect(renderToString(createElement(None))).toBe('null');
  });
});
