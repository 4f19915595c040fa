import { afterEach, describe, expect, it, vi } from 'vitest';
import { createViewerStore } from './state/store.ts';
import { keepHud } from './viewer-page.tsx';

let kept: string | null;

/** A store with the figures of a page on such a device. */
function storeOn(device: 'phone' | 'desktop') {
  vi.stubGlobal('matchMedia', () => ({ matches: device === 'phone' }));
  const store = createViewerStore();
  keepHud(store);
  return store;
}

function keep(_: string, text: string): void {
  kept = text;
}

function storeTexts(setItem = keep): void {
  vi.stubGlobal('localStorage', { getItem: () => kept, setItem });
}

afterEach(() => vi.unstubAllGlobals());

describe('the figures of a page', () => {
  it('are as they were left, on phones too', () => {
    kept = null;
    storeTexts();
    storeOn('desktop').setState({ hudSize: 'large' });
    const after = storeOn('phone');
    expect(after.getState()).toMatchObject({ isHudVisible: true, hudSize: 'large' });
    after.setState({ isHudVisible: false });
    expect(storeOn('desktop').getState().isHudVisible).toBe(false);
  });

  it('are closed at first on phones only', () => {
    kept = null;
    storeTexts();
    expect(storeOn('phone').getState().isHudVisible).toBe(false);
    expect(storeOn('desktop').getState()).toMatchObject({ isHudVisible: true, hudSize: null });
  });

  it.each(['', '{', 'null', '3', '{"isHudVisible":true,"hudSize":"huge"}', '{"hudSize":"large"}'])(
    'are as usual where %j was kept',
    (text) => {
      kept = text;
      storeTexts();
      expect(storeOn('desktop').getState()).toMatchObject({ isHudVisible: true, hudSize: null });
    },
  );

  it('are kept nowhere where a page may not store anything', () => {
    kept = null;
    storeTexts(() => {
      throw new DOMException('', 'QuotaExceededError');
    });
    const store = storeOn('desktop');
    store.setState({ hudSize: 'small' });
    expect(store.getState().hudSize).toBe('small');
  });
});
