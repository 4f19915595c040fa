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

it('leaves other errors to the next boundary', () => {
  const error = new SplatFileError('empty', 'a.ply', 'has no splats');
  expect(() => shownAfter(error, { fallback: 'a photograph' })).toThrow(error);
});
