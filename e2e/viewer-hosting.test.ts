import { afterAll, beforeAll, describe, expect, it } from 'vitest';
import { builtApp } from './server.ts';
import { type StaticHost, startStaticHost } from './static-host.ts';
import { textOf, viewerHarness, waitForImage } from './viewer-page.ts';

const harness = viewerHarness();
let host: StaticHost;

beforeAll(async () => {
  host = await startStaticHost(await builtApp('apps/viewer'), '/some/where/');
});
afterAll(() => host?.close());

describe('the viewer on plain static hosting, below a path', () => {
  it('draws, and its links lead to the gallery, to a case and back', async () => {
    const page = await harness.newPage();
    await page.goto(`${host.url}index.html?scene=still-life-small`);
    await waitForImage(page);
    expect(await textOf(page, 'scene-title')).toContain('Still life');

    await page.goto(`${host.url}index.html?scene=hard&q=camera-orthographic`);
    await page.getByTestId('gallery-case').getByRole('link').first().click();
    await waitForImage(page);
    expect(await textOf(page, 'scene-title')).toBe('camera-orthographic');
    await page.getByRole('link', { name: 'All hard cases' }).click();
    await page.getByTestId('gallery').waitFor();
    await page.getByRole('link', { name: 'WebSplatter' }).click();
    await waitForImage(page);
    expect(await textOf(page, 'scene-title')).toContain('Still life');
  });
});
