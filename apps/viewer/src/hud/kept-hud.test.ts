import { describe, expect, it } from 'vitest';
import { createViewerStore } from '../state/store.ts';
import { keepHud } from './kept-hud.ts';

function storageWith(text: string | null = null) {
  const kept = { text };
  return {
    kept,
    getItem: () => kept.text,
    setItem: (_: string, value: string) => {
      kept.text = value;
    },
  };
}

const onPhone = (query: string) => query.includes('coarse');
const elsewhere = () => false;

describe('the figures of a page', () => {
  it('are as they were left, on phones too', () => {
    const storage = storageWith();
    const before = createViewerStore();
    keepHud(before, storage, elsewhere);
    before.setState({ hudSize: 'large' });
    const after = createViewerStore();
    keepHud(after, storage, onPhone);
    expect(after.getState()).toMatchObject({ isHudVisible: true, hudSize: 'large' });
    after.setState({ isHudVisible: false });
    const last = createViewerStore();
    keepHud(last, storage, elsewhere);
    expect(last.getState().isHudVisible).toBe(false);
  });

  it('are closed at first on phones only', () => {
    const phone = createViewerStore();
    keepHud(phone, storageWith(), onPhone);
    expect(phone.getState().isHudVisible).toBe(false);
    const other = createViewerStore();
    keepHud(other, storageWith(), elsewhere);
    expect(other.getState()).toMatchObject({ isHudVisible: true, hudSize: 'medium' });
  });

  it.each(['', '{', 'null', '3', '{"isHudVisible":true,"hudSize":"huge"}', '{"hudSize":"large"}'])(
    'are as usual where %j was kept',
    (text) => {
      const store = createViewerStore();
      keepHud(store, storageWith(text), elsewhere);
      expect(store.getState()).toMatchObject({ isHudVisible: true, hudSize: 'medium' });
    },
  );

  it('are kept nowhere where a page may not store anything', () => {
    const store = createViewerStore();
    const full = {
      getItem: () => null,
      setItem: () => {
        throw new DOMException('', 'QuotaExceededError');
      },
    };
    keepHud(store, full, elsewhere);
    store.setState({ hudSize: 'small' });
    expect(store.getState().hudSize).toBe('small');
    keepHud(createViewerStore(), null, elsewhere);
  });
});
