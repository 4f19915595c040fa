const BLOCK_BYTES = 1 << 17;

/** Numbers from 0 to 65,535 that are the same everywhere. */
function numbers(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1103515245) + 12345) >>> 0;
    return state >>> 16;
  };
}

function words(): Uint8Array {
  const next = numbers(1);
  const stems = ['position', 'scale', 'rotation', 'opacity', 'color', 'harmonics'];
  return new TextEncoder().encode(
    Array.from({ length: 300 }, () => stems[next() % 6] + (next() % 10)).join(' '),
  );
}

function bellShaped(): Uint8Array {
  const next = numbers(7);
  const half = () => ((next() % 12) * (next() % 12)) >> 4;
  return Uint8Array.from({ length: 1200 }, () => 128 + half() - half());
}

/** Data packed by zstd 1.5, with every kind of literals and every way to give a table. */
export const ZSTD_EXAMPLES: readonly {
  readonly name: string;
  readonly unpacked: Uint8Array;
  readonly packed: Uint8Array<ArrayBuffer>;
}[] = [
  {
    name: 'words in three blocks: Huffman codes and tables, new and taken from the block before; a checksum',
    unpacked: words(),
    packed: fromBase64(
      'KLUv/QRodAcAcgUREbA7P8kMwUPqMLqRlqgUYHIV3LthCbMKbQcjEG3AoIlgdx8sdrhXb3LDM4n9cgWlp/ct+6hiXnayRphMaZ+DfYIFvgtYqCHqdSptBjBEgJQ78xEgCMdBnTdaWs0BpNKDpVdicKjG5MccsZ8aEWkjeJJ6BsxfAAT+UFoD63eqzCaet7ebmqCiFppAZNlBHLMvyawigKTmESitORHhpaiXDpqP/AySHFcwT5kydGEdICH8zZB7yyYibAUkL0Q/uXrNLy/vSynNccs+tSlH7AgqelANJXOdAXC+D2c/ki+Dlii3Uil+2v7VR5lXAZwFAOOBBC7IqobVZkGEEIQABi4A2TBEB1HoMERAlKIrDxEgBBgjMdrMJFPYzAGdtjlsXpVCVoN1ROyRNNBjK8wH6ftmvzE7tuzD7wORy43EsbbMSDevLrP2Ob2kFkC4Fo96wtbjmI88KmUCImnKxog65SWHpjQUkBw+jtmwTgxkjxlhNQZfxNvm8HZ+wxBSBcVCq3OCcOL1M8Vu0nhtJcQmIPfWmAoM7Sj/QDvNjLUH7NDhJnDjTAUA40EEuqSVWceKBcqgBRN3QrqDGBxN+BFIFEqZjkwgGNQ5Q2gjgsHy8utdEhMZ352QEGgE41gENEMetyUl6xWiFuDk3cP+s/W9R4cvUDfD6U8k2JLbzbhHOoOPUEzani9bwORMKMWQdkqLfYXRBJm55WB9DLPW5aCtyMqEVYnocqxDKKBOqIkIzpNlyowv16Lm0ZOHdN3qWK/nxEviIPx5pvkBq1akh5VTBwEAAFJQYfQ=',
    ),
  },
  {
    name: 'values about a middle in three blocks: four Huffman streams, the usual tables',
    unpacked: bellShaped(),
    packed: fromBase64(
      'KLUv/QRYZAYA1tcuEMCl0AGE7C1lkntv/v///7IpACsAKwDC1Yow3KNgK2MmvCyeGLn495FjnhXhcDjx4Lsq4sPjafciaTkMI4wvAY0CXJPWhgT5BZIR/TLCMuBgCDivzDU2cTrNHOBTGDIdpqR9nW2ClPg0QQc0SOcUYMBUsJ+4FN9sfA5irAH2i+wB6DIoTwSa2SOmNNoSegI8BjUImxcNBzL0GH35vTxcf9llV8VKLvpXNugXsff3IVskbKgoLjLHuONQDwQAco6EqHp3tOoOV3AGdAYAttcuEqAlSQekkS1lkntvYlVVVVXViykAKQAoADMuG7dL2hNQjBIoBKZmYBnPzdAk78QJYxDuG1vzFPoCYbMUT3ReW68DnQhZ3ASaBIUpy7wk5wBFNL2JXXxG/BI98MueaVLFDMZKCOi6iY1jwwlvHemleVDqGI5TfpppHbkB9zT8wYxql2rM6jiuFziYRrpkzFz2xw0HF4m6Bf2mjXI9Yt41FDoOd3UKYzk56wI9aMxLuJpuB2tgyBL20t6IAQQAVtJKtI09EJHWjiUs6AHMBQAHlygmACcAKAAzTpCpeeCzwgRetUd+KDc7Udg4PttzEwtQMx5wts2hOVfVn9LyAYdg8+UOsnDQQIGhZ80owX1mtI+3/lpq05MgsZ5FewoaetRnQki2FLdcybQ77iDQzchAfgxRaIKcQPCjSYkHkDqhgzARXZo3627VIUF85HyzyxeEsCJXwhTqhVnniJ5TkLmsdwn0xc30RLAENuSmKSiJizW9DywGAAddU9Ll5BDZ1rTDZILvzeoQvAEAAFcCs1Y=',
    ),
  },
  {
    name: 'the same in one block: tables of one symbol',
    unpacked: bellShaped(),
    packed: fromBase64(
      'KLUv/WCwA70QAOpJHAgSoCVJB5aQLWWSe28yAAAAAOBxfgB7AHkAJMKBRLC/+Ag+2jgdyCgW9s/shboUzptRNLvInEorpr4CPfsYiMAYPWlFhMWmYlRj/lGzqn9oPIeDQMB5Z66yi9SL6AA+hzLUAIlpX2nb+Pu0+EVS/49FO4O4V8FWCm38TCahWfDvNAs9O0Mi8eLBd0IUJy5fu4ualoEAjfEnQhY3gSZBYcoyL8k5QBFNb2IX//UZ8Uv04Jc906SKOcZKCOi6iY2BDWfGZeN2SXsGxSiBQjA1gyXw3AxN8k6cMI5w39iap9AXhM1SPNF5bb0+GKpH6c/v58DiL/tsIWRiFvWvrNRPZO+fOXYiK2osIETwmTnKHal6BaYzzwoTeMNftUd+KDc7Udg4PttzEwtQMz7+jbNtDs2fyFxVf0rLXyTqFvSbNsr1iHnXUOg43NUpjOXkrAt0gALzEq6m22MNhixhL+2N+OLfOtJL81FqYDhO+WmmdeQO7mn4x4xqlyowq2PgesFjGumSwMwlO7EfuOFOArPLF4SwIlfCFOqFWeeInlOQuax3CfTFzfTEuD9LsCE3TaMkLtb0PtgtVzLtjnsE3Ywc8oEhCk2QE4wfTUo8gNQJPcJEdGnerLtVhwTxkfOHsflyB1l4NFAw9KwZZdxnAu3jrb+W2vQkSKxn0Z6Chh71mRCSLc04QabmgQEDRBsDZ6B7poavFAI=',
    ),
  },
];

function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
}

/** Zstandard data that holds bytes as they are, or a run of equal ones as a run. */
export function storeZstd(bytes: Uint8Array): Uint8Array<ArrayBuffer> {
  const size = [0, 8, 16, 24].map((shift) => (bytes.length >> shift) & 255);
  const parts: Uint8Array[] = [Uint8Array.of(0x28, 0xb5, 0x2f, 0xfd, 0xa0, ...size)];
  for (let start = 0; start === 0 || start < bytes.length; start += BLOCK_BYTES) {
    const block = bytes.subarray(start, start + BLOCK_BYTES);
    const isRun = block.length > 0 && block.every((byte) => byte === block[0]);
    const isLast = start + BLOCK_BYTES >= bytes.length;
    const head = (isLast ? 1 : 0) | (isRun ? 2 : 0) | (block.length << 3);
    parts.push(
      Uint8Array.of(head & 255, (head >> 8) & 255, head >> 16),
      isRun ? block.subarray(0, 1) : block,
    );
  }
  return Uint8Array.from(Buffer.concat(parts));
}
