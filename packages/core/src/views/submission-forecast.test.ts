import { describe, expect, test } from 'vitest';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { type ForecastPlan, SubmissionForecast } from './submission-forecast.ts';

const BUDGET_MS = 250;
const cloudOf = (storage = {}) => ({ planes: { storage } }) as SplatCloud;
const CLOUD = cloudOf();
const FULL_HD = { widthPx: 1920, heightPx: 1080 };

function planOf(visibleSplats: number, layer = FULL_HD, cloud = CLOUD): ForecastPlan {
  return { needs: { visibleSplats, depthBits: 24 }, layer, clouds: [{ instance: { cloud } }] };
}

/** Times of a frame without other work on the device or the page. */
function timesOf(elapsedMs: number) {
  return { totalMs: elapsedMs, wallClockMs: elapsedMs };
}

describe('SubmissionForecast', () => {
  test('lets any device draw few splats, or small images, at once', () => {
    const forecast = new SubmissionForecast(BUDGET_MS);
    expect(forecast.mayExceed(planOf(0))).toBe(false);
    expect(forecast.mayExceed(planOf(5))).toBe(false);
    expect(forecast.mayExceed(planOf(2000, { widthPx: 64, heightPx: 64 }))).toBe(false);
  });

  test('expects the worst of clouds that were never drawn, also beside others', () => {
    const forecast = new SubmissionForecast(BUDGET_MS);
    expect(forecast.mayExceed(planOf(100_000))).toBe(true);
    forecast.takeParts(planOf(100_000), 1);
    expect(forecast.mayExceed(planOf(100_000))).toBe(false);
    expect(forecast.mayExceed(planOf(100_000, FULL_HD, cloudOf()))).toBe(true);
  });

  test('knows a cloud by the previews of its load', () => {
    const forecast = new SubmissionForecast(BUDGET_MS);
    const storage = {};
    forecast.takeParts(planOf(100_000, FULL_HD, cloudOf(storage)), 1);
    expect(forecast.mayExceed(planOf(400_000, FULL_HD, cloudOf(storage)))).toBe(false);
    expect(forecast.mayExceed(planOf(400_000, FULL_HD, cloudOf()))).toBe(true);
  });

  test('follows the last frame, and expects as many times its time as there are more splats and pixels', () => {
    const forecast = new SubmissionForecast(BUDGET_MS);
    forecast.takeParts(planOf(100_000), 100);
    expect(forecast.mayExceed(planOf(240_000))).toBe(false);
    expect(forecast.mayExceed(planOf(260_000))).toBe(true);
    expect(forecast.mayExceed(planOf(100_000, { widthPx: 3840, heightPx: 2160 }))).toBe(true);
    forecast.take(planOf(100_000), timesOf(251));
    // Fewer splats may be nearer, and larger.
    expect(forecast.mayExceed(planOf(10_000))).toBe(true);
  });

  /**
   * @fault Time: timestamps are far below the truth, or one frame is late
   * @consequence neither misleads the forecast
   */
  test('is not misled by one frame that other work kept waiting, nor by timestamps far below the truth', () => {
    const forecast = new SubmissionForecast(BUDGET_MS);
    const late = { totalMs: 1, wallClockMs: 900 };
    forecast.take(planOf(100_000), timesOf(1));
    forecast.take(planOf(100_000), late);
    expect(forecast.mayExceed(planOf(100_000))).toBe(false);
    forecast.take(planOf(100_000), late);
    forecast.take(planOf(100_000), late);
    expect(forecast.mayExceed(planOf(100_000))).toBe(true);
  });

  test('never divides where the budget is infinite', () => {
    expect(new SubmissionForecast(Number.POSITIVE_INFINITY).mayExceed(planOf(1e9))).toBe(false);
  });
});
