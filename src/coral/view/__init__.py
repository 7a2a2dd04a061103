"""Map pictures, video, run reports and the live view.

A wing. It needs `coral.reef.products` and `coral.reef.recordings` for the page of products, and knows the types of
`coral.reef.sea`.
"""
