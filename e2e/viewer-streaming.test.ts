import { writeSplats } from '@websplatter/core/write';
import { expect, it } from 'vitest';
import { testScene } from './test-scene.ts';
import { CHEAP, CHEAPLY, showFigures, viewerHarness, waitForImage } from './viewer-page.ts';

const harness = viewerHarness({ 'city.bricks': await writeSplats(testScene(40_000), 'bricks') });

it('says how much of a scene is there, and fetches again what could not be', async () => {
  harness.expectProblem(/403/);
  harness.server.answerParts('refuse');
  const page = await harness.openShared(`?url=city.bricks&${CHEAPLY}`);
  await showFigures(page);
  const retry = page.getByTestId('stream-error').getByRole('button', { name: 'Try again' });
  await retry.waitFor();
  const figure = (name: string) => page.getByTestId(name).innerText();
  await expect.poll(() => figure('bricks')).toBe('2 of 12, 10 not fetched');
  harness.server.answerParts('hold');
  await retry.click();
  await retry.waitFor({ state: 'detached' });
  expect(await page.getByTestId('error').count()).toBe(0);
  harness.server.answerParts('send');
  await waitForImage(page);
  await expect.poll(() => figure('bricks')).toBe('12 of 12');
  await expect.poll(() => figure('fetched')).toMatch(/^\d{3} kB$/);
});

it('says nothing of bricks where none are', async () => {
  const page = await harness.shareViewer(CHEAP);
  await showFigures(page);
  expect(await page.getByTestId('bricks').isVisible()).toBe(false);
  expect(await page.getByTestId('stream-error').count()).toBe(0);
});
