import { expect, test } from 'vitest';
import { ByteLedger } from './byte-ledger.ts';

test('the ledger follows objects that grow, shrink and go, part by part, and keeps the peak', () => {
  const ledger = new ByteLedger();
  const [texture, buffer] = [{}, {}];
  ledger.set(buffer, 100);
  ledger.set(texture, 40, 'level 0');
  ledger.set(texture, 10, 'level 1');
  expect(ledger.bytes).toBe(150);
  ledger.set(buffer, 30);
  expect(ledger.bytes).toBe(80);
  ledger.delete(texture);
  ledger.delete(texture);
  ledger.delete({});
  expect(ledger.bytes).toBe(30);
  expect(ledger.peakBytes).toBe(150);
});
