import type { Mutation } from '@websplatter/conformance';
import { useEffect, useState } from 'react';
import { CaseImages } from './case-images.ts';

/**
 * Images that are destroyed when the component unmounts; null before the first effect and while
 * `areWanted` is false.
 */
export function useCaseImages(areWanted: boolean, mutation?: Mutation): CaseImages | null {
  const [images, setImages] = useState<CaseImages | null>(null);
  useEffect(() => {
    if (!areWanted) return;
    const made = new CaseImages(mutation);
    setImages(made);
    return () => made.destroy();
  }, [areWanted, mutation]);
  return images;
}
