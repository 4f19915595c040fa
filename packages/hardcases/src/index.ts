export * from './hard-case.ts';
