/** Whether this is `npm run test:full`, which has the tests that take long or that others show too. */
export const isFull = process.env.WEBSPLATTER_FULL === '1';
