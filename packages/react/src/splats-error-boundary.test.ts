import { SplatFileError, WebGpuUnavailableError } from '@websplatter/core';
import { renderToStaticMarkup } from 'react-dom/server';
import { expect, it } from 'vitest';
import { SplatsErrorBoundary, type SplatsErrorBoundaryProps } from './splats-error-boundary.tsx';

const unavailable = new WebGpuUnavailableError('WebGPU is not available here.');

/** Returns the markup after `error` has been thrown inside of the boundary. */
function shownAfter(error: unknown, props: SplatsErrorBoundaryProps): string {
  const boundary = new SplatsErrorBoundary(props);
  boundary.state = SplatsErrorBoundary.getDerivedStateFromError(error);
  return renderToStaticMarkup(boundary.render());
}

it('shows its children until they fail', () => {
  expect(renderToStaticMarkup(new SplatsErrorBoundary({ children: 'splats' }).render())).toBe('splats');
});

it('tells visitors what to try, and nothing that only developers could use, or shows its fallback', () => {
  const sentence = shownAfter(unavailable, { children: 'splats' });
  expect(sentence).toMatch(/^<p role="alert">This 3D view cannot be shown here\. Try .+ Safari\.<\/p>$/);
  expect(sentence).not.toContain(unavailable.message);
  expect(shownAfter(unavailable, { fallback: 'a photograph' })).toBe('a photograph');
  expect(shownAfter(unavailable, { fallback: ({ code }) => code })).toBe('webgpu-unavailable');
  expect(shownAfter(unavailable, { fallback: null })).toBe('');
});

/**
 * @fault three.js and React: the address of splats is wrong, or their file is damaged, and nothing handles it
 * @consequence `<SplatsErrorBoundary>` shows a sentence, or its fallback; the rest of the page stays
 */
it('shows a sentence without names of other browsers for files that cannot be shown', () => {
  const empty = new SplatFileError('empty', 'a.ply', 'has no splats');
  const sentence = shownAfter(empty, { children: 'splats' });
  expect(sentence).toBe(
    '<p role="alert">This 3D view could not be loaded. Reload the page to try again.</p>',
  );
  expect(shownAfter(empty, { fallback: ({ message }) => message })).toContain('a.ply');
});

it('leaves errors that are not of splats to the next boundary', () => {
  const error = new TypeError('x is not a function');
  expect(() => shownAfter(error, { fallback: 'a photograph' })).toThrow(error);
});
